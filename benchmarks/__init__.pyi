from .families import family_scene as family_scene, random_vertex as random_vertex
from .hard import CASES as CASES, run_case as run_case
from .reference import solve_reference as solve_reference
from .search import (
    draw_search as draw_search,
    measure_search as measure_search,
    search_tables as search_tables,
)
