"""Compiled code on disk is read only if it is whole, and nobody else could have written it."""

import os
import stat

import pytest

from kickdrift.core import sealed

posix = pytest.mark.skipif(os.name != "posix", reason="folders of users are theirs alone")


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "new" / "a.nbc"
    for content in (b"", b"code", bytes(range(256)) * 100):
        sealed.write(path, content)
        assert sealed.read(path) == content
    assert [file.name for file in path.parent.iterdir()] == ["a.nbc"]


@pytest.mark.parametrize("bit", [0, 8 * 31 + 7, 8 * 32, 8 * 36 + 5])
def test_another_bit_anywhere_is_found(bit, tmp_path):
    path = tmp_path / "a.nbc"
    sealed.write(path, b"code!")
    content = bytearray(path.read_bytes())
    content[bit // 8] ^= 1 << bit % 8
    path.write_bytes(content)
    with pytest.raises(ValueError, match="is damaged"):
        sealed.read(path)
    path.write_bytes(content[:20])
    with pytest.raises(ValueError, match="is damaged"):
        sealed.read(path)


@posix
@pytest.mark.parametrize("bit", [stat.S_IWGRP, stat.S_IWOTH])
@pytest.mark.parametrize("which", ["folder", "file"])
def test_what_others_can_write_is_not_read(which, bit, tmp_path):
    path = tmp_path / "folder" / "a.nbc"
    sealed.write(path, b"code")
    open_ = path if which == "file" else path.parent
    open_.chmod(stat.S_IMODE(open_.stat().st_mode) | bit)
    with pytest.raises(PermissionError, match="could have been written by others"):
        sealed.read(path)
    sealed.write(path, b"code")  # closes what is one's own
    assert sealed.read(path) == b"code"


@posix
def test_what_others_own_is_not_read(tmp_path, monkeypatch):
    path = tmp_path / "folder" / "a.nbc"
    sealed.write(path, b"code")
    monkeypatch.setattr(sealed, "_trusted", lambda: frozenset((os.geteuid() + 1,)))
    with pytest.raises(PermissionError, match="could have been written by others"):
        sealed.read(path)


@posix
def test_a_mask_that_lets_the_group_write_does_not_lay_the_cache_idle(tmp_path):
    before = os.umask(0o002)
    try:
        sealed.write(tmp_path / "folder" / "a.nbc", b"code")
    finally:
        os.umask(before)
    assert sealed.read(tmp_path / "folder" / "a.nbc") == b"code"
