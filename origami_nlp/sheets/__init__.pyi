from .account import SheetSearch as SheetSearch
from .angle_sums import pop_rows as pop_rows
from .clearance import Clearance as Clearance, Stretches as Stretches
from .confirming import Confirmed as Confirmed, confirm_minimum as confirm_minimum
from .counts import (
    Overview as Overview,
    jacobian_rank as jacobian_rank,
    overview as overview,
)
from .curve import (
    Curve as Curve,
    follow_curve as follow_curve,
    tangents as tangents,
)
from .curve_passes import curve_passes as curve_passes
from .descent import Descended as Descended, descend as descend
from .drawing import (
    draw_found as draw_found,
    draw_motion as draw_motion,
    draw_overview as draw_overview,
    draw_sheet as draw_sheet,
    draw_states as draw_states,
    sheet_view as sheet_view,
)
from .find import find_states as find_states
from .flat_folded import (
    FlatFolded as FlatFolded,
    list_branches as list_branches,
    list_flat_folded as list_flat_folded,
)
from .fold_out import (
    sheet_frame as sheet_frame,
    sheet_parts as sheet_parts,
    sheet_to_fold as sheet_to_fold,
)
from .interpolant import (
    Interpolant as Interpolant,
    interpolate as interpolate,
    wells as wells,
)
from .judgement import (
    classified as classified,
    judge as judge,
    singular_beside as singular_beside,
)
from .marks import touch_places as touch_places
from .motion import Motion as Motion, find_motion as find_motion
from .noise import is_overdetermined as is_overdetermined
from .pressing import press as press, press_along as press_along, press_off as press_off
from .result import SheetResult as SheetResult
from .turnable import (
    sheet_content as sheet_content,
    sheet_poser as sheet_poser,
    turn_found as turn_found,
    turn_motion as turn_motion,
)
