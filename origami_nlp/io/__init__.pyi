from .console import screen as screen
from .plain import (
    Finite as Finite,
    OneBased as OneBased,
    Unbounded as Unbounded,
    check_schema as check_schema,
    from_plain as from_plain,
    to_plain as to_plain,
)
from .reading import (
    as_text as as_text,
    check_tables as check_tables,
    one_of as one_of,
    parse_json as parse_json,
    parse_toml as parse_toml,
    read_json as read_json,
    read_limited as read_limited,
    read_toml as read_toml,
)
from .reprs import (
    PrettyRepr as PrettyRepr,
    ShortRepr as ShortRepr,
    cut as cut,
)
from .text import is_number as is_number, is_unicode as is_unicode, printable as printable
from .writing import (
    check_outputs as check_outputs,
    check_writable as check_writable,
    figure_bytes as figure_bytes,
    is_stdout as is_stdout,
    make_folder as make_folder,
    save_figure as save_figure,
    write_json as write_json,
    write_whole as write_whole,
)
