"""Interfaces of the core stay narrow: what a new term or solver has to know is counted in the headers."""

import re
from pathlib import Path

import pytest

CORE = Path(__file__).parent.parent / "cpp" / "visviva"
LIMITS = {
    ("term/term.hpp", "Term"): 10,
    ("term/term.hpp", "MeshAssembly"): 4,
    ("term/term.hpp", "NeighbourSearch"): 4,
    ("term/term.hpp", "TermMemory"): 4,
    ("term/term.hpp", "TermHistory"): 3,
    ("linear/linear.hpp", "LinearSolver"): 6,
    ("linear/linear.hpp", "RigidSolver"): 4,
    ("linear/linear.hpp", "SolverSequence"): 4,
    ("linear/reduce/reduction.hpp", "Reduction"): 6,
}
"""Virtual methods of a class, its destructor apart."""


def body(source: str, name: str) -> str:
    """What stands between the braces of a class."""
    start = re.search(rf"^class {name}\b[^;{{]*{{", source, re.MULTILINE)
    assert start, f"no class {name}"
    depth, at = 1, start.end()
    while depth:
        depth += {"{": 1, "}": -1}.get(source[at], 0)
        at += 1
    return source[start.end() : at]


def virtuals(source: str, name: str) -> list[str]:
    return re.findall(r"\bvirtual\s[^~(;]*?(\w+)\(", re.sub(r"//.*", "", body(source, name)))


def test_virtual_methods_are_counted() -> None:
    source = """
    class Other { virtual void other(); };
class Some : public Other {
  public:
    virtual ~Some() = default;
    virtual void one(int) const = 0;  // virtual
    virtual std::vector<double> two() { return {}; }
    void three() override;
};
class Next { virtual void four(); };
"""
    assert virtuals(source, "Some") == ["one", "two"]


@pytest.mark.parametrize(("header", "name"), LIMITS)
def test_interfaces_are_narrow(header: str, name: str) -> None:
    found = virtuals((CORE / header).read_text(), name)
    assert 0 < len(found) <= LIMITS[header, name], found
