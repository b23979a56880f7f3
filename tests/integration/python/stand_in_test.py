"""The client against a server that fails on purpose: repetitions, deadlines, TLS, answers that break the contract."""

import pathlib
import subprocess
import tempfile
import threading
import time
import unittest
from collections.abc import Iterable
from concurrent import futures
from typing import Any
from unittest import mock

import grpc
import maploc
import numpy as np
from maploc.v1 import localization_service_pb2 as pb
from maploc.v1 import localization_service_pb2_grpc, map_service_pb2, map_service_pb2_grpc, types_pb2

VIEW = maploc.View(maploc.Camera(maploc.CameraModel.PINHOLE, 640, 480, (500, 500, 320, 240)))
UNAVAILABLE = (grpc.StatusCode.UNAVAILABLE, "lost", ())
QUEUE_FULL = (
    grpc.StatusCode.RESOURCE_EXHAUSTED,
    "the queue is full (QUEUE_FULL)",
    (("maploc-reason", "QUEUE_FULL"), ("grpc-retry-pushback-ms", "20")),
)
DISK_FULL = (
    grpc.StatusCode.UNAVAILABLE,
    "no space; free some (DISK_FULL)",
    (("maploc-reason", "DISK_FULL"), ("grpc-retry-pushback-ms", "10000")),
)


def no_consensus() -> pb.LocalizeResponse:
    """A whole answer without a pose."""
    return pb.LocalizeResponse(outcome=2, strategy=2, strategy_source=1)


class StandIn(localization_service_pb2_grpc.LocalizationServiceServicer):
    """Fails as its list says, call by call, then answers."""

    def __init__(self, failures: Iterable[tuple[grpc.StatusCode, str, tuple[tuple[str, str], ...]]] = ()) -> None:
        self.failures = list(failures)
        self.answer = no_consensus()
        self.requests: list[Any] = []
        self.authorizations: list[str | None] = []
        self.hold = threading.Event()
        self.hold.set()

    def StartSession(self, request: pb.StartSessionRequest, context: Any) -> pb.StartSessionResponse:
        """A session."""
        self.take(request, context)
        return pb.StartSessionResponse(session_id="s-1", map_version=1)

    def Localize(self, request: pb.LocalizeRequest, context: Any) -> pb.LocalizeResponse:
        """The answer."""
        self.take(request, context)
        return self.answer

    def EndSession(self, request: pb.EndSessionRequest, context: Any) -> pb.EndSessionResponse:
        """The end of the session."""
        self.take(request, context)
        return pb.EndSessionResponse(end=pb.SESSION_END_BY_ROBOT, query_count=1)

    def take(self, request: Any, context: Any) -> None:
        """Notes the request, and fails if that is its turn."""
        self.requests.append(request)
        self.authorizations.append(dict(context.invocation_metadata()).get("authorization"))
        self.hold.wait(timeout=30)
        if self.failures:
            code, message, trailers = self.failures.pop(0)
            context.set_trailing_metadata(trailers)
            context.abort(code, message)


class OneMap(map_service_pb2_grpc.MapServiceServicer):
    """A map without features. Its versions are told call by call, the last one for ever."""

    versions = [0]

    def GetMap(self, request: map_service_pb2.GetMapRequest, context: Any) -> map_service_pb2.GetMapResponse:
        """The map."""
        source = types_pb2.Similarity3(scale=1, rotation=types_pb2.Quaternion(w=1), translation=types_pb2.Vector3())
        version = self.versions[0] if len(self.versions) == 1 else self.versions.pop(0)
        found = map_service_pb2.Map(name=request.map, version=version, map_from_source=source)
        return map_service_pb2.GetMapResponse(map=found)


class StandInTest(unittest.TestCase):
    """One stand-in a test."""

    def serve(self, stand_in: StandIn, credentials: grpc.ServerCredentials | None = None) -> int:
        """Serves until the test's end; the port."""
        server = grpc.server(futures.ThreadPoolExecutor(2))
        localization_service_pb2_grpc.add_LocalizationServiceServicer_to_server(stand_in, server)
        map_service_pb2_grpc.add_MapServiceServicer_to_server(OneMap(), server)
        address = "127.0.0.1:0"
        port = server.add_secure_port(address, credentials) if credentials else server.add_insecure_port(address)
        server.start()
        self.addCleanup(lambda: server.stop(None).wait())
        return int(port)

    def client(self, stand_in: StandIn, **options: Any) -> maploc.Client:
        """A client of it."""
        port = self.serve(stand_in)
        return self.enterContext(maploc.Client(f"127.0.0.1:{port}", **options))

    def test_a_query_outside_of_a_session_is_repeated(self) -> None:
        stand_in = StandIn([UNAVAILABLE, UNAVAILABLE])
        answer = self.client(stand_in).localize("yard", VIEW)
        self.assertIs(answer.outcome, maploc.Outcome.TOO_FEW_MATCHES)
        self.assertEqual(len(stand_in.requests), 3)

    def test_the_attempts_are_bounded(self) -> None:
        stand_in = StandIn([UNAVAILABLE] * 9)
        with self.assertRaisesRegex(maploc.MaplocError, "lost"):
            self.client(stand_in).localize("yard", VIEW)
        self.assertEqual(len(stand_in.requests), 4)

    def test_a_lost_query_in_a_session_is_repeated_by_its_id(self) -> None:
        stand_in = StandIn()
        with self.client(stand_in).session("yard", "cart") as session:
            stand_in.failures = [UNAVAILABLE]
            session.localize(VIEW)
            session.localize(VIEW, options=maploc.QueryOptions(request_id="mine"))
        first, second, mine = [request for request in stand_in.requests if isinstance(request, pb.LocalizeRequest)]
        self.assertNotEqual(first.request_id, "")
        self.assertEqual(first, second)
        self.assertEqual(mine.request_id, "mine")

    def test_the_time_of_a_call_holds_for_its_repetitions_too(self) -> None:
        stand_in = StandIn([UNAVAILABLE] * 3)
        begin = time.monotonic()
        with self.assertRaisesRegex(maploc.MaplocError, "lost"):
            self.client(stand_in, timeout_seconds=0.25).localize("yard", VIEW)
        self.assertLess(time.monotonic() - begin, 1.0)
        self.assertLess(len(stand_in.requests), 4)

    def test_too_many_calls_on_a_connection_are_repeated_later(self) -> None:
        stand_in = StandIn([(grpc.StatusCode.RESOURCE_EXHAUSTED, "too many calls (CALL_RATE)", ())])
        begin = time.monotonic()
        self.client(stand_in).localize("yard", VIEW)
        self.assertGreater(time.monotonic() - begin, 0.9)

    def test_a_version_of_the_map_is_asked_for(self) -> None:
        stand_in = StandIn()
        client = self.client(stand_in)
        client.localize("yard", VIEW, options=maploc.QueryOptions(map_version=4))
        client.session("yard", "cart", map_version=5)
        self.assertEqual([request.map_version for request in stand_in.requests], [4, 5])
        with self.assertRaisesRegex(maploc.MaplocError, "map_version"):
            maploc.QueryOptions(map_version=-1)

    def test_a_session_knows_the_version_that_it_is_on(self) -> None:
        mismatch = (("maploc-reason", "MAP_VERSION_MISMATCH"),)
        stand_in = StandIn([(grpc.StatusCode.FAILED_PRECONDITION, "version 4 is enabled", mismatch)])
        client = self.client(stand_in)
        with mock.patch.object(OneMap, "versions", [3, 4]):  # an import comes in between
            session = client.session("yard", "cart")
        self.assertEqual([request.map_version for request in stand_in.requests], [3, 4])
        self.assertEqual(session.map.version, 4)

    def test_a_version_that_cannot_be_is_refused_by_name(self) -> None:
        client = self.client(StandIn())
        for wrong in (2**63, -1, 1.5, "1"):
            with self.assertRaises(maploc.MaplocError) as raised:
                client.session("yard", "cart", map_version=wrong)  # type: ignore[arg-type]
            self.assertEqual(raised.exception.field, "map_version")

    def test_a_repeated_start_is_one_session(self) -> None:
        stand_in = StandIn([UNAVAILABLE])
        with self.client(stand_in).session("yard", "cart"):
            pass
        first, second, _ = stand_in.requests
        self.assertNotEqual(first.request_id, "")
        self.assertEqual(first, second)

    def test_what_the_server_refused_before_it_began_is_repeated_in_a_session_too(self) -> None:
        stand_in = StandIn()
        with self.client(stand_in).session("yard", "cart") as session:
            stand_in.failures = [QUEUE_FULL, QUEUE_FULL]
            session.localize(VIEW)
        self.assertEqual([type(request) for request in stand_in.requests].count(pb.LocalizeRequest), 3)

    def test_a_long_wait_is_left_to_the_caller(self) -> None:
        stand_in = StandIn([DISK_FULL])
        with self.assertRaises(maploc.MaplocError) as raised:
            self.client(stand_in).localize("yard", VIEW)
        error = raised.exception
        self.assertEqual((error.code, error.reason, error.cure), ("UNAVAILABLE", "DISK_FULL", "free some"))
        self.assertEqual(str(error), "UNAVAILABLE (DISK_FULL): no space; free some")
        self.assertEqual(len(stand_in.requests), 1)

    def test_a_server_that_does_not_answer_is_left(self) -> None:
        stand_in = StandIn()
        stand_in.hold.clear()
        self.addCleanup(stand_in.hold.set)
        with self.assertRaisesRegex(maploc.MaplocError, r"no answer within 0\.3 s") as raised:
            self.client(stand_in, timeout_seconds=0.3).localize("yard", VIEW)
        self.assertEqual(raised.exception.code, "DEADLINE_EXCEEDED")

    def test_an_answer_that_breaks_its_contract_is_no_pose(self) -> None:
        whole = types_pb2.Rigid3(rotation=types_pb2.Quaternion(w=1), translation=types_pb2.Vector3())
        good = no_consensus()
        good.outcome, good.covariance[:] = pb.OUTCOME_LOCALIZED, np.eye(6).ravel()
        good.map_from_body.CopyFrom(whole)
        stand_in = StandIn()
        client = self.client(stand_in)
        stand_in.answer = good
        self.assertIsNotNone(client.localize("yard", VIEW).pose)

        def broken(**fields: Any) -> pb.LocalizeResponse:
            answer = pb.LocalizeResponse.FromString(good.SerializeToString())
            for name in fields:
                answer.ClearField(name)
            answer.MergeFrom(pb.LocalizeResponse(**fields))
            return answer

        doubled = types_pb2.Rigid3(rotation=types_pb2.Quaternion(w=2), translation=types_pb2.Vector3())
        for answer in (
            broken(outcome=pb.OUTCOME_LOW_CONFIDENCE),  # with a pose
            broken(outcome=99),
            broken(map_from_body=None),
            broken(map_from_body=doubled),
            broken(covariance=[1.0]),
            broken(covariance=[float("nan")] * 36),
            broken(point_matches=pb.FeatureMatches(feature_indices=[0], inliers=b"\1")),  # none was sent
            broken(line_matches=pb.FeatureMatches(feature_indices=[0])),
        ):
            stand_in.answer = answer
            with self.assertRaisesRegex(maploc.MaplocError, "breaks its contract") as raised:
                client.localize("yard", VIEW)
            self.assertEqual(raised.exception.code, "INTERNAL")

    def test_tls_and_a_token(self) -> None:
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        key, certificate = folder / "key.pem", folder / "certificate.pem"
        command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
        command += ["-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"]
        command += ["-keyout", str(key), "-out", str(certificate)]
        subprocess.run(command, check=True, capture_output=True)
        stand_in = StandIn()
        credentials = grpc.ssl_server_credentials([(key.read_bytes(), certificate.read_bytes())])
        address = f"localhost:{self.serve(stand_in, credentials)}"
        with maploc.Client(address, root_certificates=certificate, token="secret") as client:
            client.localize("yard", VIEW)
        self.assertEqual(stand_in.authorizations, ["Bearer secret"])
        with maploc.Client(address) as stranger, self.assertRaises(maploc.MaplocError) as raised:
            stranger.localize("yard", VIEW)
        self.assertEqual(raised.exception.code, "UNAVAILABLE")
        self.assertIn("TLS", raised.exception.cure)


if __name__ == "__main__":
    unittest.main()
