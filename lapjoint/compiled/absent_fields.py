"""Fields that are None: code for them is left out before numba looks at it.

A field of a `by_reference` tuple is None where there is nothing to hold, and its type says so.  Code below ``if
tables.field is not None`` is then left out, with all functions that only it calls: these would be compiled, and never
run.  numba does so by itself for arguments that are None, not for fields of arguments.
"""

from __future__ import annotations

import operator
from typing import Any

from numba import types
from numba.core import ir
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.consts import ConstantInference
from numba.core.ir_utils import get_definition, guard
from numba.core.untyped_passes import InlineClosureLikes, InlineInlinables

from lapjoint.compiled.by_reference import ByReference

_COMPARISONS = {operator.is_: True, operator.is_not: False}
"""Each comparison with None, and whether it is true for a field that is None."""


class Compiler(CompilerBase):  # type: ignore[misc]
    """numba's compiler, which knows from the types which fields are None."""

    def define_pipelines(self) -> list[Any]:
        """numba's passes, and `_AbsentFields` before each time that numba leaves out code that cannot run."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        for before in (InlineClosureLikes, InlineInlinables):
            passes.add_pass_after(_AbsentFields, before)
        passes.finalize()
        return [passes]


@register_pass(mutates_CFG=False, analysis_only=False)
class _AbsentFields(FunctionPass):  # type: ignore[misc]
    """Replaces comparisons of fields with None by their results."""

    _name = "absent_fields"

    def __init__(self) -> None:  # abstract in numba
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Whether there was such a comparison in the function."""
        code, changed = state.func_ir, False
        for block in code.blocks.values():
            for assignment in block.find_insts(ir.Assign):
                known = _known(code, state.args, assignment.value)
                if known is not None:
                    definitions = code._definitions[assignment.target.name]
                    constant = ir.Const(known, assignment.loc)
                    definitions[definitions.index(assignment.value)] = assignment.value = constant
                    changed = True
        if changed:
            code._consts = ConstantInference(code)
        return changed


def _known(code: Any, arguments: Any, value: Any) -> bool | None:
    """The result of a comparison of a field of an argument with None; None for all else."""
    if not (isinstance(value, ir.Expr) and value.op == "binop" and value.fn in _COMPARISONS):
        return None
    left, right = (guard(get_definition, code, side) for side in (value.lhs, value.rhs))
    if not (isinstance(right, ir.Const) and right.value is None):
        return None
    if not (isinstance(left, ir.Expr) and left.op == "getattr"):
        return None
    argument = guard(get_definition, code, left.value)
    kind = arguments[argument.index] if isinstance(argument, ir.Arg) else None
    field = kind.field(left.attr) if isinstance(kind, ByReference) else None
    return None if field is None else isinstance(field.type, types.NoneType) == _COMPARISONS[value.fn]
