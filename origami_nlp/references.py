"""What to cite for a result: the software, the source paper, and what the result records that it was found with.

A reference stands here once; when it is named is decided by what a result holds, so that a solver that was not run is
not named.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_path, check_type
from origami_nlp.display import Report, Result, Section, Words
from origami_nlp.version import __version__


@dataclass(frozen=True)
class Reference:
    """Something to cite.

    Attributes
    ----------
    key
        Of its BibTeX entry.
    why
        What a result has of it, in words.
    kind
        Of the BibTeX entry: ``article``, ``software``, ``misc``, ...
    authors
        Family names and given names, as BibTeX has them (``and`` between two).
    title
        Of the work.
    year
        "" where none is known.
    doi, url
        Where it is found; "" where there is none, and no URL where there is a DOI.
    fields
        Where it appeared, as BibTeX has it: journal, volume, pages, ...
    """

    key: str
    why: str
    kind: str
    authors: str
    title: str
    year: str = ""
    doi: str = ""
    url: str = ""
    fields: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The reference in a line, as it stands in a list of references."""
        people = [" ".join(reversed(a.split(", "))) for a in self.authors.split(" and ")]
        some = ", ".join(people[:-1]) + " and " * (len(people) > 1) + people[-1]
        some = some.replace(" and others", " et al.").replace("{", "").replace("}", "")
        volume = self.fields.get("volume", "") + (
            f"({self.fields['number']})" if "number" in self.fields else ""
        )
        names = ("journal", "booktitle", "howpublished", "note")
        work = next((self.fields[name] for name in names if name in self.fields), "")
        place = " ".join(filter(None, (work, volume)))
        pages = self.fields.get("pages", "").replace("--", "-")
        version = f"version {self.fields['version']}" if "version" in self.fields else ""
        link = f"doi:{self.doi}" if self.doi else self.url
        parts = (f"{self.title}", place, version, pages and f"pp. {pages}", self.year, link)
        return f"{some}: " + ", ".join(filter(None, parts))

    def bibtex(self) -> str:
        """Return the BibTeX entry."""
        fields = {
            "author": self.authors,
            "title": f"{{{self.title}}}",
            **self.fields,
            "year": self.year,
            "doi": self.doi,
            "url": self.url,
        }
        lines = "".join(
            f"  {name} = {{{value if name in ('doi', 'url') else _tex(value)}}},\n"
            for name, value in fields.items()
            if value
        )
        return f"@{self.kind}{{{self.key},\n{lines}}}\n"


def _tex(text: str) -> str:
    return re.sub(r"([_&])", r"\\\1", text)


REFERENCES = (
    Reference(
        "origami_nlp",
        "the software",
        "software",
        "{The origami_nlp developers}",
        "origami_nlp: the stable states of origami vertices, found, classified and proved",
        fields={"version": __version__},
    ),
    Reference(
        "grasinger_lagrangian",
        "the Lagrangian approach to vertices that it implements",
        "unpublished",
        "Grasinger, Matthew and Gillman, Andrew and Buskohl, Philip R.",
        "Lagrangian approach to origami vertex analysis: Multistability",
        fields={"note": "Manuscript; data: doi 10.5281/zenodo.22719444"},
    ),
    Reference(
        "casadi",
        "CasADi: derivatives of energy, closure and contact",
        "article",
        "Andersson, Joel A. E. and Gillis, Joris and Horn, Greg and Rawlings, James B. and Diehl, Moritz",
        "CasADi: a software framework for nonlinear optimization and optimal control",
        "2019",
        "10.1007/s12532-018-0139-4",
        fields={
            "journal": "Mathematical Programming Computation",
            "volume": "11",
            "number": "1",
            "pages": "1--36",
        },
    ),
    Reference(
        "ipopt",
        "IPOPT: solved the nonlinear program, started at states that were found",
        "article",
        "Wächter, Andreas and Biegler, Lorenz T.",
        "On the implementation of an interior-point filter line-search algorithm for large-scale nonlinear programming",
        "2006",
        "10.1007/s10107-004-0559-y",
        fields={
            "journal": "Mathematical Programming",
            "volume": "106",
            "number": "1",
            "pages": "25--57",
        },
    ),
    Reference(
        "clarabel",
        "Clarabel: the conic problem of a design",
        "misc",
        "Goulart, Paul J. and Chen, Yuwen",
        "Clarabel: An interior-point solver for conic programs with quadratic objectives",
        "2024",
        "10.48550/arXiv.2405.12762",
        fields={"howpublished": "arXiv:2405.12762"},
    ),
    Reference(
        "arb",
        "python-flint and Arb: the ball arithmetic of the check of a proof",
        "article",
        "Johansson, Fredrik",
        "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic",
        "2017",
        "10.1109/TC.2017.2690633",
        fields={
            "journal": "IEEE Transactions on Computers",
            "volume": "66",
            "number": "8",
            "pages": "1281--1292",
        },
    ),
    Reference(
        "fold",
        "the FOLD format: a file that was read or written",
        "inproceedings",
        "Demaine, Erik D. and Ku, Jason S. and Lang, Robert J.",
        "A New File Standard to Represent Folded Structures",
        "2016",
        url="https://erikdemaine.org/papers/FOLD_CGW2016/",
        fields={"booktitle": "Abstracts of the 26th Fall Workshop on Computational Geometry"},
    ),
    Reference(
        "numpy",
        "NumPy: arrays and dense linear algebra",
        "article",
        "Harris, Charles R. and Millman, K. Jarrod and van der Walt, Stéfan J. and others",
        "Array programming with NumPy",
        "2020",
        "10.1038/s41586-020-2649-2",
        fields={"journal": "Nature", "volume": "585", "pages": "357--362"},
    ),
    Reference(
        "scipy",
        "SciPy: sparse matrices",
        "article",
        "Virtanen, Pauli and Gommers, Ralf and Oliphant, Travis E. and others",
        "SciPy 1.0: fundamental algorithms for scientific computing in Python",
        "2020",
        "10.1038/s41592-019-0686-2",
        fields={"journal": "Nature Methods", "volume": "17", "pages": "261--272"},
    ),
    Reference(
        "matplotlib",
        "Matplotlib: a figure that was written",
        "article",
        "Hunter, John D.",
        "Matplotlib: A 2D graphics environment",
        "2007",
        "10.1109/MCSE.2007.55",
        fields={
            "journal": "Computing in Science & Engineering",
            "volume": "9",
            "number": "3",
            "pages": "90--95",
        },
    ),
)
"""All that a result may be cited with, in order of importance."""
_ALWAYS = ("origami_nlp", "grasinger_lagrangian", "numpy")
_BY_ENDING = {".fold": "fold", ".png": "matplotlib", ".pdf": "matplotlib", ".svg": "matplotlib"}
_DEPTH = 12
"""Results within results that are looked into: a design holds minima, which hold states, with what IPOPT says."""


@dataclass(frozen=True, repr=False)
class Citations(Report):
    """References for a result: prints itself as a list, and as BibTeX with `bibtex`.

    Attributes
    ----------
    references
        In order of importance.
    """

    references: tuple[Reference, ...]

    def report_sections(self) -> Iterator[Section]:
        """Return a line each: what it is cited for, and the reference."""
        yield Words(f"{len(self.references)} references, for what this result records")
        for number, one in enumerate(self.references, start=1):
            yield Words(f"[{number}] {one.why}\n    {one.text}")

    def bibtex(self) -> str:
        """Return all of them as BibTeX entries."""
        return "\n".join(one.bibtex() for one in self.references)

    def _rows(self) -> Iterator[dict[str, object]]:
        names = ("key", "why", "authors", "title", "year", "doi")
        yield from ({name: getattr(one, name) for name in names} for one in self.references)


def citations(result: Any, *files: str | PathLike[str]) -> Citations:
    """Name what to cite for a result, by what it records: solvers that ran, files that were read.

    Parameters
    ----------
    result
        Anything that a function of `origami_nlp` returned that is a result, or the `proof.Check` of a proof.
    files
        Files that were written from it: a FOLD file or a figure is cited by its ending.

    Returns
    -------
    Citations
        The software and the source paper first.

    Raises
    ------
    OptionError
        If `result` is no result, or a file is no path.

    Notes
    -----
    A result that was read back from JSON does not know from which file its scene or pattern came; Matplotlib and the
    FOLD format are named where `files` ask for them.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16, prove=False)
    >>> [one.key for one in o.citations(result, "states.fold").references]
    ['origami_nlp', 'grasinger_lagrangian', 'casadi', 'ipopt', 'fold', 'numpy']
    """
    from origami_nlp.proof import Check

    if not isinstance(result, Check):
        check_type("result", result, Result)
    for k, file in enumerate(files, start=1):
        check_path(f"files[{k}]", file)
    used = {*_ALWAYS, *(_BY_ENDING.get(Path(fspath(file)).suffix.lower(), "") for file in files)}
    used.update(_recorded(result, set(), _DEPTH))
    return Citations(tuple(one for one in REFERENCES if one.key in used))


def _recorded(thing: Any, seen: set[int], depth: int) -> Iterator[str]:
    """Name what a result, and all that it holds, says that it was found with."""
    if id(thing) in seen or depth == 0:
        return
    seen.add(id(thing))
    if isinstance(thing, tuple | list | dict):
        inner = list(thing.values() if isinstance(thing, dict) else thing)
        if inner and isinstance(inner[0], int | float | str):  # fold angles and such
            return
    elif type(thing).__module__.startswith("origami_nlp.") and hasattr(thing, "__dict__"):
        yield from _of_itself(thing)
        inner = list(vars(thing).values())
    else:
        return
    for one in inner:
        if not isinstance(one, int | float | str | np.ndarray):
            yield from _recorded(one, seen, depth - 1)


def _of_itself(thing: Any) -> Iterator[str]:
    """Name what one record says that it was found with."""
    from origami_nlp.inverse_design import Design
    from origami_nlp.minima import JudgedState, SearchReport
    from origami_nlp.pattern import Pattern, Scene
    from origami_nlp.pattern_problem import SignVector
    from origami_nlp.proof import Check

    match thing:
        case Scene() | Pattern():
            yield "casadi" if isinstance(thing, Scene) else "scipy"
            name, vertex = re.fullmatch(r"(.*?)(, vertex \d+)?", thing.source, re.S).groups()  # type: ignore[union-attr]
            piped = name == "standard input" and (vertex or isinstance(thing, Pattern))
            if piped or Path(name).suffix.lower() in (".fold", ".json"):
                yield "fold"
        case JudgedState() if thing.solver is not None:
            yield from ("casadi", "ipopt")
        case SearchReport() if thing.solves or getattr(thing, "of_vertex", 0):
            yield from ("casadi", "ipopt")
        case Design() if thing.iterations:
            yield from ("clarabel", "scipy")
        case SignVector():
            yield "clarabel"
        case Check():
            yield "arb"
