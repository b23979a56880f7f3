"""The one exception of this package."""

import re
from typing import NoReturn

# What helps, where the message itself does not say it.
_CURES = {
    "MAP_NOT_FOUND": "Client.maps() lists the maps that the server has",
    "SESSION_NOT_FOUND": "start a new session",
    "SESSION_CLOSED": "start a new session",
    "DEADLINE_EXCEEDED": "give Client a longer timeout_seconds, or send fewer features",
    "UNAVAILABLE": "is maploc-server running there, and do both sides use TLS or neither?",
    "DESCRIPTOR_SCALE": "take maploc.detect_points, or scale them as the kind's definition in types.proto says",
    "UNAUTHENTICATED": "give Client a token that the server knows",
    "PERMISSION_DENIED": "use a token whose role may do this",
}

# "views[0].points.coordinates_pixels[3]: must be finite"
_FIELD = re.compile(r"([A-Za-z_][\w.\[\]]*): (.+)", re.DOTALL)


class MaplocError(Exception):
    """An input was wrong, or a call failed. "Not localized" is no error but an answer.

    Attributes:
        code: gRPC's canonical code, for example "INVALID_ARGUMENT". Inputs that are refused before any call have it
            too.
        reason: UPPER_SNAKE, for programs, for example "ZERO_GRAVITY". The code again where gRPC itself failed.
        field: the input that is wrong, as the request names it ("views[0].camera.params[0]"), or a file and its line;
            "" where it is about no input.
        message: what is wrong, with the cure, for people.
        cure: what to do, as far as it is known; else "".
    """

    def __init__(self, code: str, reason: str, message: str, *, field: str = "", cure: str | None = None) -> None:
        self.code = code
        self.reason = reason
        self.message = message
        self.field = field or _field_of(message)
        told = message.partition("; ")[2] if cure is None else cure
        self.cure = told or _CURES.get(reason, "") or _CURES.get(code, "")
        super().__init__(self._text())

    def _text(self) -> str:
        head = self.code if self.code == self.reason else f"{self.code} ({self.reason})"
        known = not self.cure or self.cure in self.message
        return f"{head}: {self.message}" + ("" if known else f"; {self.cure}")


def invalid(field: str, message: str, reason: str = "INVALID_FIELD") -> NoReturn:
    """Refuses an input before it is sent. `message` says what is wrong with it and, behind "; ", the cure."""
    raise MaplocError("INVALID_ARGUMENT", reason, f"{field}: {message}", field=field)


def _field_of(message: str) -> str:
    match = _FIELD.fullmatch(message)
    return match.group(1) if match else ""
