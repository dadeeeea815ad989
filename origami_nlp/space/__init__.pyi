from .chain import HalfChain as HalfChain, chain_of as chain_of
from .figure import draw_space as draw_space
from .find import find_space as find_space
from .mesh import MeshError as MeshError
from .result import Space as Space, angle_words as angle_words
