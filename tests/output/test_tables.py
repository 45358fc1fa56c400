"""Tables: every bit kept, torn lines dropped."""

import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from visviva.base.errors import InputError
from visviva.output import Table, read_table


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.lists(st.floats(), min_size=3, max_size=3), max_size=8))
def test_table_keeps_every_bit(tmp_path, rows):
    with Table(tmp_path / "a.csv", ["time", "b", "c"]) as table:
        for row in rows:
            table.append(row)
    columns = read_table(tmp_path / "a.csv")
    assert list(columns) == ["time", "b", "c"]
    found = np.column_stack(list(columns.values()))
    expected = np.array(rows, dtype=float).reshape(-1, 3)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(np.signbit(found[~np.isnan(found)]), np.signbit(expected[~np.isnan(found)]))


def test_table_resumes_and_drops_a_torn_line(tmp_path):
    path = tmp_path / "a.csv"
    table = Table(path, ["time", "x"])
    for k in range(10):
        table.append([k / 10, k])
        if k == 6:
            checksum = table.checksum
    with path.open("ab") as file:
        file.write(b"1.0,0.33")
    assert read_table(path)["x"].tolist() == list(range(10))
    with Table.reopen(path, ["time", "x"], 7, checksum) as resumed:
        resumed.append(np.array([0.7, -1.0]))
    assert read_table(path)["x"].tolist() == [0, 1, 2, 3, 4, 5, 6, -1]
    with Table.reopen(path, ["time", "x"], 0, zlib.crc32(b"time,x\n")):
        assert read_table(path)["x"].tolist() == []
    with pytest.raises(InputError, match="other columns"):
        Table.reopen(path, ["time", "y"], 0, 0)
    with pytest.raises(InputError, match=r"a.csv: is damaged \(its first 7 rows"):
        Table.reopen(path, ["time", "x"], 7, checksum)


def test_table_refuses(tmp_path):
    for columns in ([], ["x"], ["time", "a,b"], ["time", "time"], ["time", ""]):
        with pytest.raises(InputError):
            Table(tmp_path / "a.csv", columns)
    with Table(tmp_path / "a.csv", ["time", "x"]) as table, pytest.raises(InputError, match="3 values for 2"):
        table.append([0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="cannot be read"):
        read_table(tmp_path / "missing.csv")
    (tmp_path / "b.csv").write_text("time,x\n0,hello\n")
    with pytest.raises(InputError, match="not a table"):
        read_table(tmp_path / "b.csv")
