"""What a check of a proof may use, and which proofs it takes."""

import ast
from pathlib import Path

import pytest

import origami_nlp.proof.check as check_module
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.problem import Model
from origami_nlp.proof import certificate_of, check_proof, prove, write_certificate
from tests.command_line import run

SCENE = Scene(
    Vertex.from_degrees((70, 80, 120, 90)),
    (1, 2, 3, 2),
    (1.0, -0.5, 0.3, 0.8),
    symmetry="none",
    contact="fold-limits",
)


def test_the_proof_of_a_vertex_is_not_checked_and_says_so(tmp_path):
    certificate, path = certificate_of(SCENE, prove(Model(SCENE))), tmp_path / "proof.json"
    with pytest.raises(OptionError, match="vertex"):
        check_proof(certificate)
    write_certificate(certificate, path)
    done = run("check-proof", path)
    assert done.code == 2 and not done.out
    assert done.err.count("\n") == 1 and "of a vertex" in done.err


def test_the_check_shares_nothing_with_the_search():
    """All that the check may use of the package: the reading of scenes and files."""
    folder = Path(check_module.__file__).parent
    own = [*folder.glob("*certificate.py"), *sorted(folder.glob("check*.py"))]
    assert len(own) == 9
    known = {f"origami_nlp.proof.{path.stem}" for path in own}
    for path in own:
        tree = ast.parse(path.read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                modules = [node.module or ""]
            elif isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            else:
                continue
            for module in modules:
                if module.startswith("origami_nlp"):
                    allowed = {"origami_nlp.errors", "origami_nlp.io", "origami_nlp.pattern"}
                    assert module in known | allowed, f"{path.name} imports {module}"
                assert module.split(".")[0] not in ("pickle", "marshal", "shelve", "importlib")
        calls = {
            n.func.id
            for n in ast.walk(tree)
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        }
        assert not calls & {"eval", "exec", "__import__", "compile"}
