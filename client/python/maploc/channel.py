"""Calls with a deadline, repeated until then. Only for client.py."""

import os
import random
import re
import time
from collections.abc import Callable
from typing import Any, TypeVar

import grpc

from maploc.errors import MaplocError, invalid
from maploc.proxy import is_loopback, proxy_in_use

Response = TypeVar("Response")

_REASON = "maploc-reason"
_PUSHBACK = "grpc-retry-pushback-ms"  # gRFC A6
_MAX_ATTEMPTS = 4
_FIRST_BACKOFF_SECONDS = 0.1  # doubles an attempt
_CALL_RATE_WAIT_SECONDS = 1.0
_LONGEST_WAIT_SECONDS = 2.0  # a server that asks for more is not waited for: its refusal is raised
# A server that starts again is found within seconds, not after gRPC's default of two minutes; what gRPC calls the
# least backoff is the time that one attempt to connect may take.
_RECONNECT_MS = {
    "grpc.initial_reconnect_backoff_ms": 100,
    "grpc.min_reconnect_backoff_ms": 5000,
    "grpc.max_reconnect_backoff_ms": 2000,
}


class Channel:
    """One connection to one server. Thread-safe."""

    def __init__(
        self, address: str, timeout_seconds: float, root_certificates: str | os.PathLike[str] | None, token: str | None
    ) -> None:
        if not timeout_seconds > 0:
            invalid("timeout_seconds", "must be positive")
        if token is not None and re.fullmatch(r"[\x21-\x7e]+", token) is None:
            invalid("token", "must be ASCII without blanks; strip the end of the line that it was read from")
        if token is not None and root_certificates is None and not is_loopback(address):
            invalid("token", "would be sent in the clear; give root_certificates, so that the connection uses TLS")
        self.address = address
        self._timeout_seconds = timeout_seconds
        self._metadata = () if token is None else (("authorization", f"Bearer {token}"),)
        # Else gRPC lets all clients of a process share one connection, and its flow control.
        options: list[tuple[str, int]] = [*_RECONNECT_MS.items(), ("grpc.use_local_subchannel_pool", 1)]
        if is_loopback(address):
            options.append(("grpc.enable_http_proxy", 0))  # which cannot reach this machine's own loopback
        if root_certificates is None:
            self.grpc = grpc.insecure_channel(address, options)
        else:
            roots = grpc.ssl_channel_credentials(_read(root_certificates))
            self.grpc = grpc.secure_channel(address, roots, options)

    def call(self, method: Callable[..., Response], request: Any) -> Response:
        """The answer. The call must be safe to repeat although the server may have seen it."""
        deadline = time.monotonic() + self._timeout_seconds
        attempt, backoff = 1, _FIRST_BACKOFF_SECONDS
        while True:
            try:
                return method(request, timeout=deadline - time.monotonic(), metadata=self._metadata)
            except grpc.RpcError as error:
                wait = _wait_seconds(error, backoff)
                if wait is None or attempt == _MAX_ATTEMPTS or time.monotonic() + wait >= deadline:
                    raise self._error_of(error) from None
            time.sleep(wait)
            attempt, backoff = attempt + 1, backoff * 2

    def _error_of(self, error: Any) -> MaplocError:
        code, details = error.code().name, error.details() or ""
        reason = _trailer(error, _REASON)
        if reason is not None:
            # The service repeats its reason behind the message, for tools that show nothing else.
            return MaplocError(code, reason, details.removesuffix(f" ({reason})"))
        if _is_call_rate(error):
            return MaplocError(code, "CALL_RATE", details.removesuffix(" (CALL_RATE)"))
        if code == "DEADLINE_EXCEEDED":
            details += f" (no answer within {self._timeout_seconds:g} s)"
        proxy, cure = proxy_in_use(self.address) if code in ("UNAVAILABLE", "DEADLINE_EXCEEDED") else "", ""
        if proxy:
            cure = f"the call went through the proxy {proxy}, put the host into no_proxy to reach it directly"
        return MaplocError(code, code, f"server {self.address}: {details}", cure=cure)


def _wait_seconds(error: Any, backoff: float) -> float | None:
    """How long to wait before a failed call is made again; None: it is not."""
    pushback = _trailer(error, _PUSHBACK)
    wait = backoff
    if pushback is not None and pushback.isascii() and pushback.isdecimal():
        wait = max(int(pushback) / 1000, backoff)
        if int(pushback) / 1000 > _LONGEST_WAIT_SECONDS:
            return None
    elif _is_call_rate(error):
        wait = max(_CALL_RATE_WAIT_SECONDS, backoff)
    elif error.code() != grpc.StatusCode.UNAVAILABLE:
        return None
    # Robots that were refused together must not come back together: up to a quarter more.
    return wait * random.uniform(1, 1.25)


def _is_call_rate(error: Any) -> bool:
    """A connection with too many calls is refused where gRPC sends no trailing metadata: the text alone says so."""
    details = error.details() or ""
    return error.code() == grpc.StatusCode.RESOURCE_EXHAUSTED and details.endswith(" (CALL_RATE)")


def _trailer(error: Any, key: str) -> str | None:
    values = [value for name, value in error.trailing_metadata() or () if name == key]
    return str(values[0]) if values else None


def _read(path: str | os.PathLike[str]) -> bytes:
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        invalid("root_certificates", f"{os.fspath(path)} cannot be read ({error.strerror}); give a PEM file")
