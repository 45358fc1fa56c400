"""Interfaces of the core stay narrow: what a new term or solver has to know is counted in the headers."""

import re
from pathlib import Path

CORE = Path(__file__).parent.parent / "cpp" / "visviva"
MOST = 10
"""Virtual methods that a class declares, its destructor and those that it overrides apart."""
LIMITS = {
    "MeshAssembly": 4,
    "NeighbourSearch": 4,
    "TermMemory": 4,
    "TermHistory": 3,
    "LinearSolver": 6,
    "RigidSolver": 4,
    "SolverSequence": 4,
    "Reduction": 6,
}
"""Of those that are narrower."""
WIDE = {"Gaps": 24, "PointGaps": 11}
"""Exactly those of a class that is wider: a class that shrinks leaves its lower number here."""


def body(source: str, start: int) -> str:
    """What follows a brace that opens, to the one that closes it."""
    depth, at = 1, start
    while depth:
        depth += {"{": 1, "}": -1}.get(source[at], 0)
        at += 1
    return source[start : at - 1]


def virtuals(source: str) -> dict[str, list[str]]:
    """Virtual methods by the class that declares them, its destructor apart."""
    plain = re.sub(r"//[^\n]*|/\*.*?\*/", "", source, flags=re.DOTALL)
    found = {}
    for head in re.finditer(r"\b(?:class|struct)\s+(\w+)[^;(){}=]*{", plain):
        names = re.findall(r"\bvirtual\s[^~(;]*?(\w+)\(", body(plain, head.end()))
        if names:
            found[head[1]] = names
    return found


FOUND = {
    name: names
    for path in sorted(CORE.rglob("*.?pp"))
    for name, names in virtuals(path.read_text(encoding="utf-8")).items()
}


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
struct Next {
    /* virtual void never(); */
    virtual void four();
};
template <class T> struct Plain : Some { T five() const; };
"""
    assert virtuals(source) == {"Other": ["other"], "Some": ["one", "two"], "Next": ["four"]}


def test_every_interface_is_narrow() -> None:
    too_wide = {name: len(names) for name, names in FOUND.items() if len(names) > LIMITS.get(name, MOST)}
    assert too_wide == WIDE


def test_limits_are_about_classes_that_exist() -> None:
    assert set(LIMITS) | {"Term", "IterationLimit"} <= set(FOUND)
