"""Types of the fields of a problem, and the base of its parts: a frozen table that refuses unknown keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from lapjoint.errors import InputError
from lapjoint.problem.messages import in_sentences, shown
from lapjoint.problem.slips import number_meant

FloatArray = npt.NDArray[np.float64]
"""Real numbers in double precision; docstrings say shape and unit."""
IntArray = npt.NDArray[np.int64]
"""Whole numbers; docstrings say shape and what they count."""


def _refuse_text_and_booleans(value: object) -> object:
    if isinstance(value, str | bool):
        raise ValueError(f"must be a number{number_meant(value) if isinstance(value, str) else ''}")
    return value


_Number = BeforeValidator(_refuse_text_and_booleans)
Finite = Annotated[float, _Number, Field(allow_inf_nan=False)]
Positive = Annotated[float, _Number, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, _Number, Field(ge=0, allow_inf_nan=False)]
Whole = Annotated[int, _Number]
AtLeastOne = Annotated[float, _Number, Field(ge=1)]  # infinite allowed
SpringStiffness = Annotated[float, _Number, Field(ge=0)]  # infinite allowed, NaN refused by ge


if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)  # pydantic has no public name for it


class _InSentences(ModelMetaclass):
    """Makes a part in Python raise the messages that the command line has for a file, one sentence for each fault."""

    def __call__(cls, *args: Any, **given: Any) -> Any:  # noqa: N805, whose self is a class
        try:
            return super().__call__(*args, **given)
        except ValidationError as error:
            raise InputError(in_sentences(error, given, cast(type[BaseModel], cls), cls.__name__)) from None


class Part(BaseModel, metaclass=_InSentences):
    """Base of every part of a problem: frozen, and unknown keys are refused, by an `InputError`."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @model_validator(mode="before")
    @classmethod
    def _text_has_an_encoding(cls, data: Any) -> Any:
        """Refuse text that UTF-8 cannot hold, as a file name of another encoding becomes in an argument."""
        for key, value in data.items() if isinstance(data, dict) else ():
            if isinstance(value, str) and _has_surrogate(value):
                raise ValueError(f"{key} = {shown(value)}: must be text that UTF-8 can hold")
        return data


def _has_surrogate(text: str) -> bool:
    """Whether there is half of a surrogate pair in a text, which no encoding holds."""
    return any("\ud800" <= sign <= "\udfff" for sign in text)
