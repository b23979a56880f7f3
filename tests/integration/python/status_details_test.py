"""google.rpc.Status in a refusal's trailing metadata, read as a client does that knows nothing of maploc: by the published
field numbers of google/rpc/status.proto and error_details.proto."""

import unittest
from typing import Any

import grpc
from maploc.v1 import localization_service_pb2 as pb
from maploc.v1 import localization_service_pb2_grpc
from room_test_case import RoomTestCase

_PREFIX = "type.googleapis.com/google.rpc."


def varint(data: bytes, at: int) -> tuple[int, int]:
    """A number, and where it ends."""
    value = shift = 0
    while True:
        byte = data[at]
        value, shift, at = value | (byte & 127) << shift, shift + 7, at + 1
        if byte < 128:
            return value, at


def fields(data: bytes) -> dict[int, list[Any]]:
    """A message's numbers and bytes, by field number."""
    found: dict[int, list[Any]] = {}
    at = 0
    while at < len(data):
        key, at = varint(data, at)
        value: Any
        value, at = varint(data, at)
        if key & 7 == 2:
            value, at = data[at : at + value], at + value
        found.setdefault(key >> 3, []).append(value)
    return found


class StatusDetailsTest(RoomTestCase):
    """What comes beside the code and the message."""

    def refusal(self, method: str, request: Any) -> tuple[Any, dict[int, list[Any]], dict[str, dict[int, list[Any]]]]:
        """The error, its Status, and the Status's details by their names."""
        with grpc.insecure_channel(self.server.address) as channel:
            stub = localization_service_pb2_grpc.LocalizationServiceStub(channel)  # type: ignore[no-untyped-call]
            with self.assertRaises(grpc.RpcError) as raised:
                getattr(stub, method)(request, timeout=10)
        error: Any = raised.exception
        status = fields(dict(error.trailing_metadata())["grpc-status-details-bin"])
        details = {}
        for packed in status[3]:
            any_message = fields(packed)
            name = any_message[1][0].decode()
            self.assertTrue(name.startswith(_PREFIX), name)
            details[name.removeprefix(_PREFIX)] = fields(any_message[2][0])
        return error, status, details

    def test_an_unknown_map_has_its_reason_alone(self) -> None:
        error, status, details = self.refusal("StartSession", pb.StartSessionRequest(map="attic", robot="cart"))
        self.assertEqual(status[1], [error.code().value[0]])
        self.assertIn(status[2][0].decode(), error.details())
        self.assertEqual(details, {"ErrorInfo": {1: [b"MAP_NOT_FOUND"], 2: [b"maploc"]}})

    def test_a_wrong_field_is_named(self) -> None:
        _, status, details = self.refusal("Localize", pb.LocalizeRequest(map="room", map_version=-1, views=[pb.View()]))
        self.assertEqual(status[1], [grpc.StatusCode.INVALID_ARGUMENT.value[0]])
        self.assertEqual(details["ErrorInfo"][1], [b"OUT_OF_RANGE"])
        violation = fields(details["BadRequest"][1][0])
        self.assertEqual(violation[1], [b"map_version"])
        self.assertTrue(violation[2][0].startswith(b"must not be negative"), violation)
        self.assertNotIn("RetryInfo", details)

    def test_a_refusal_that_passes_says_when(self) -> None:
        for i in range(100):
            self.client.session("room", "busy", {"number": str(i)})
        error, _, details = self.refusal("StartSession", pb.StartSessionRequest(map="room", robot="busy"))
        self.assertEqual(details["ErrorInfo"][1], [b"TOO_MANY_SESSIONS"])
        delay = fields(details["RetryInfo"][1][0])
        told_ms = delay.get(1, [0])[0] * 1000 + delay.get(2, [0])[0] // 1000000
        self.assertEqual(told_ms, int(dict(error.trailing_metadata())["grpc-retry-pushback-ms"]))
        self.assertGreater(told_ms, 0)


if __name__ == "__main__":
    unittest.main()
