"""What every result offers: to be drawn, saved, read back, and to become a data frame.

Nothing here knows a result: a room's result names its picture, a function of the room's face (`Result.PICTURE`), and
says what its rows are (`Result._rows`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from functools import partial
from importlib import import_module
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_path, require
from origami_nlp.display.records import record_row
from origami_nlp.errors import OptionError
from origami_nlp.io import check_schema, from_plain, read_json, to_plain, write_json, write_whole

if TYPE_CHECKING:
    from typing import Self

    import pandas
    from matplotlib.figure import Figure


class Result:
    """Something found, that can be drawn, saved, read back and made a data frame, as far as its class says how.

    Attributes
    ----------
    PICTURE
        Name of the function in the face of the class's room that draws it; "" without a picture.
    SCHEMA
        Of its JSON, a name with a version; "" where it has none.
    READS
        Whether it is read back: false where what it was made from is not in the file.
    ROWS
        Name of its field that holds the records (`display.records`) of its rows; "" where `_rows` says otherwise.

    Examples
    --------
    >>> from origami_nlp.display import Result
    >>> class Answer(Result):
    ...     def _rows(self):
    ...         yield {"answer": 42}
    >>> Answer().to_frame().shape
    (1, 1)
    """

    PICTURE = ""
    SCHEMA = ""
    READS = True
    ROWS = ""

    def draw(self, path: str | PathLike[str] | None = None) -> Figure:
        """Draw the result; the picture is the one that its command writes with ``-o FILE.png``.

        Parameters
        ----------
        path
            Where to save it (.png, .pdf or .svg), if anywhere.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; in Jupyter the last line of a cell shows it.

        Raises
        ------
        OptionError
            If there is no picture of such a result, or the file cannot be written.
        """
        if path is not None:
            check_path("path", path)
        if not self.PICTURE:
            raise self._lacks("no picture")
        from origami_nlp.io import figure_bytes, save_figure

        figure: Figure = self._from_room(self.PICTURE)(self)  # matplotlib loads here
        # what IPython asks of a result of a cell; without pyplot it knows no figures
        figure.__dict__["_repr_png_"] = partial(figure_bytes, figure, "png")
        if path is not None:
            save_figure(figure, path)
        return figure

    def save(self, path: str | PathLike[str]) -> None:
        """Write the result as JSON, whole or not at all.

        Parameters
        ----------
        path
            The file, ``.json``.

        Raises
        ------
        OptionError
            If there is no schema for such a result, or the file cannot be written.
        """
        check_path("path", path)
        if Path(path).suffix.lower() != ".json":
            raise OptionError(
                f"path = {str(path)!r} must end in .json: to_csv(path) writes tables, draw(path) pictures, write_fold "
                "and write_mesh states"
            )
        write_json(self.to_dict(), Path(path))

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a result of this class that `save`, or a command with ``-o FILE.json``, has written.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        Result
            Of this class.

        Raises
        ------
        OptionError
            If the file is no JSON, or results of this class cannot be read back.
        OrigamiError
            If the file holds another schema.
        """
        return cls.from_dict(read_data(path), repr(str(path)))

    def to_frame(self) -> pandas.DataFrame:
        """Return the result as a pandas data frame (extra ``sweep``: ``pip install "origami_nlp[sweep]"``).

        Returns
        -------
        pandas.DataFrame
            A row a state, pass, contact, ...; columns end with their unit, ``energy_J``, ``phi_1_rad``, where they have
            one (stiffnesses of scenes are taken as N m/rad).

        Raises
        ------
        OptionError
            If pandas is not installed, or such a result has no rows.
        """
        rows = [dict(row) for row in self._rows()]
        frame: pandas.DataFrame = require("pandas", "to_frame", "sweep").DataFrame(rows)
        return frame

    def to_csv(self, path: str | PathLike[str] | None = None) -> str:
        """Return the rows of `to_frame` as comma-separated text, and write them; it needs no pandas.

        Parameters
        ----------
        path
            Where to save them, if anywhere.

        Returns
        -------
        str
            Names of columns first; what is not known is empty.

        Raises
        ------
        OptionError
            If such a result has no rows, or the file cannot be written.

        Examples
        --------
        >>> import origami_nlp as o
        >>> found = o.find_minima(o.examples.miura("pi/3"), prove=False)
        >>> found.to_csv().splitlines()[0].split(",")[:4]
        ['scene', 'number', 'energy_J', 'kind']
        """
        rows = [dict(row) for row in self._rows()]
        text = StringIO(newline="")
        table = csv.DictWriter(text, list(dict.fromkeys(key for row in rows for key in row)))
        table.writeheader()
        table.writerows(rows)
        if path is not None:
            check_path("path", path)
            write_whole(Path(path), text.getvalue().encode())
        return text.getvalue()

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain JSON data.

        Returns
        -------
        dict
            With its schema under the key ``schema``.

        Raises
        ------
        OptionError
            If there is no schema for such a result.
        """
        if not self.SCHEMA:
            raise self._lacks("no schema of its own")
        return {"schema": self.SCHEMA, **to_plain(self)}

    @classmethod
    def from_dict(cls, data: dict[str, Any], what: str = "") -> Self:
        """Rebuild a result from `to_dict`.

        Parameters
        ----------
        data
            What `to_dict` returned.
        what
            How messages call it, such as a file.

        Returns
        -------
        Result
            Of this class.

        Raises
        ------
        OptionError
            If results of this class cannot be read back, or `data` is of another schema, or an entry is missing or
            wrong.
        """
        if not (cls.SCHEMA and cls.READS):
            raise cls._lacks("no way to be read back: find it anew")
        check_schema(data, cls.SCHEMA, what)
        return from_plain(cls, {k: v for k, v in data.items() if k != "schema"}, what)

    def _rows(self) -> Iterable[Mapping[str, object]]:
        """Return a mapping a row of the data frame; a class that has rows says which."""
        if not self.ROWS:
            raise self._lacks("no rows for a data frame")
        return (record_row(record) for record in getattr(self, self.ROWS))

    @classmethod
    def _from_room(cls, name: str) -> Any:
        """Return what the face of the class's room calls `name`."""
        return getattr(import_module(cls.__module__.rpartition(".")[0]), name)

    @classmethod
    def _lacks(cls, what: str) -> OptionError:
        return OptionError(f"result = a {cls.__name__} has {what}")


def angle_columns(fold_angles: Iterable[float]) -> dict[str, object]:
    """Return fold angles [N] as columns of a data frame.

    Parameters
    ----------
    fold_angles
        One a crease [rad].

    Returns
    -------
    dict
        ``phi_1_rad`` to ``phi_N_rad``.

    Examples
    --------
    >>> from origami_nlp.display import angle_columns
    >>> angle_columns([0.1, -0.2])
    {'phi_1_rad': 0.1, 'phi_2_rad': -0.2}
    """
    return {f"phi_{k}_rad": float(v) for k, v in enumerate(fold_angles, start=1)}


def read_data(path: str | PathLike[str]) -> Any:
    """Read the JSON data of a result from a file.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    object
        What the file holds.

    Raises
    ------
    OptionError
        If the file cannot be read or is no JSON.
    """
    return read_json(path, 200_000_000, "result", OptionError)
