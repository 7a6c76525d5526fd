"""What tests share that look at machine code: losing vector instructions changes no result, only the speed."""

import re

import pytest
from numba.core.registry import cpu_target


def _has_wide_vectors() -> bool:
    triple, _, features = cpu_target.target_context.codegen().magic_tuple()
    return triple.startswith("x86_64") and "+avx2" in features


needs_wide_vectors = pytest.mark.skipif(
    not _has_wide_vectors(), reason="counts the vector instructions of x86 with AVX2"
)


def packed(assembly: str, instructions: str) -> int:
    """Count instructions, a regular expression, on numbers packed in registers of 256 or 512 bits."""
    return len(re.findall(rf"^\s+(?:{instructions})pd\s.*%[yz]mm", assembly, re.MULTILINE))
