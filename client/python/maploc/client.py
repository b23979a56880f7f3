"""A robot's connection to a maploc server."""

import os
import uuid
from collections.abc import Mapping
from types import TracebackType
from typing import Self

from maploc import wire
from maploc.answer import Localization, Map, Segment, SessionSummary
from maploc.arrays import Floats, is_whole
from maploc.camera import Camera
from maploc.channel import Channel
from maploc.errors import MaplocError, invalid
from maploc.gravity import Gravity
from maploc.photo import Photo
from maploc.query import Prior, QueryOptions, View
from maploc.v1.localization_service_pb2 import EndSessionRequest, StartSessionRequest
from maploc.v1.localization_service_pb2_grpc import LocalizationServiceStub
from maploc.v1.map_service_pb2 import GetMapRequest, ListMapsRequest, ListSegmentsRequest
from maploc.v1.map_service_pb2_grpc import MapServiceStub
from maploc.view import make_view

_DEFAULT = QueryOptions()


class Client:
    """One connection to one server. Every call has a deadline; errors are MaplocError. Thread-safe.

    A call is repeated until its deadline after UNAVAILABLE, and where the server asks for it (a full queue). Every call
    of this client is safe to repeat; a query in a session counts once, by its request_id.
    """

    def __init__(
        self,
        address: str,
        *,
        timeout_seconds: float = 10.0,
        root_certificates: str | os.PathLike[str] | None = None,
        token: str | None = None,
    ) -> None:
        """Does not connect yet: the first call does.

        Args:
            address: "HOST:PORT". A server on this machine is reached without the environment's proxy.
            timeout_seconds: of a call with its repetitions.
            root_certificates: a PEM file. Given, the connection uses TLS and trusts these alone.
            token: sent with each call as `authorization: Bearer TOKEN`. Beyond this machine it takes TLS.
        """
        self._channel = Channel(address, timeout_seconds, root_certificates, token)
        grpc = self._channel.grpc
        # The plugin's code has no types.
        self._localization = LocalizationServiceStub(grpc)  # type: ignore[no-untyped-call]
        self._maps = MapServiceStub(grpc)  # type: ignore[no-untyped-call]

    def maps(self) -> list[Map]:
        """All maps, by name."""
        response = self._channel.call(self._maps.ListMaps, ListMapsRequest())
        return [wire.map_of(message) for message in response.maps]

    def map(self, name: str) -> Map:
        """One map."""
        with wire.sent_text():
            request = GetMapRequest(map=name)
        return wire.map_of(self._channel.call(self._maps.GetMap, request).map)

    def segments(self, map_name: str) -> list[Segment]:
        """A map's segments with their statistics."""
        with wire.sent_text():
            request = ListSegmentsRequest(map=map_name)
        response = self._channel.call(self._maps.ListSegments, request)
        return [wire.segment_of(message) for message in response.segments]

    def localize(
        self,
        map_name: str,
        view: View,
        *,
        gravity: Gravity | None = None,
        prior: Prior | None = None,
        options: QueryOptions = _DEFAULT,
    ) -> Localization:
        """Where was this seen? Outside of any session: the query does not count in the statistics."""
        request = wire.localize_request(view, gravity, prior, options)
        with wire.sent_text():
            request.map = map_name
        return wire.localization_of(self._channel.call(self._localization.Localize, request), view)

    def localize_photo(
        self,
        map_name: str,
        photo: Photo,
        camera: Camera,
        *,
        gravity: Gravity | None = None,
        camera_from_body: Floats | None = None,
        prior: Prior | None = None,
        options: QueryOptions = _DEFAULT,
    ) -> Localization:
        """As `localize`, with the features that the map needs found in the photo (see `make_view`)."""
        view = make_view(photo, camera, self.map(map_name), camera_from_body=camera_from_body)
        return self.localize(map_name, view, gravity=gravity, prior=prior, options=options)

    def session(
        self, map_name: str, robot: str, labels: Mapping[str, str] | None = None, *, map_version: int = 0
    ) -> "Session":
        """Starts a session, in which queries count in the statistics of the map's segments.

            with client.session("yard", "cart-7", {"season": "autumn"}) as session:
                answer = session.localize_photo("photo.jpg", camera)

        Args:
            map_name: the map; the session stays on the version that is enabled now.
            robot: the robot's name, at most 128 bytes.
            labels: free, at most 32.
            map_version: the version that the map must have: FAILED_PRECONDITION (MAP_VERSION_MISMATCH) where robots
                get another one. 0: whichever is enabled.
        """
        if not (is_whole(map_version) and 0 <= map_version < 2**63):
            invalid("map_version", "must be a whole number, not negative; 0 takes any", "OUT_OF_RANGE")
        while True:
            map_info = self.map(map_name)
            with wire.sent_text():
                request = StartSessionRequest(map=map_name, robot=robot, labels=labels, request_id=uuid.uuid4().hex)
            # Insisted on, so that the session is on the version that `map_info` describes.
            request.map_version = map_version or map_info.version
            try:
                started = self._channel.call(self._localization.StartSession, request)
            except MaplocError as error:
                if map_version or error.reason != "MAP_VERSION_MISMATCH":
                    raise
                continue  # another version was enabled in between
            if map_version not in (0, map_info.version):  # the one that was asked for was
                map_info = self.map(map_name)
            return Session(self, started.session_id, map_info)

    def end_session(self, session_id: str, *, discard: bool = False) -> SessionSummary:
        """Ends a session by its id, for example one that a robot left open when it crashed. Idempotent.

        Args:
            session_id: Session.id.
            discard: none of its queries shall count. FAILED_PRECONDITION (SESSION_CLOSED) where it has ended and
                counts.
        """
        with wire.sent_text():
            request = EndSessionRequest(session_id=session_id, discard=discard)
        return wire.summary_of(self._channel.call(self._localization.EndSession, request))

    def _localize_in_session(
        self, session_id: str, view: View, gravity: Gravity | None, prior: Prior | None, options: QueryOptions
    ) -> Localization:
        request = wire.localize_request(view, gravity, prior, options)
        request.session_id = session_id
        # A lost answer does not tell whether the query was counted: by its id it is so once.
        request.request_id = request.request_id or uuid.uuid4().hex
        return wire.localization_of(self._channel.call(self._localization.Localize, request), view)

    def close(self) -> None:
        """Closes the connection. Sessions stay open on the server until they are ended, or idle for long."""
        self._channel.grpc.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Session:
    """One robot's session on one map: a context manager, made by Client.session.

    Left normally it ends: its queries count, and `summary` says what it changed. Left by an exception, whichever
    (Ctrl-C too), it is discarded: none of its queries counts, because the robot may have gone wrong. Catch inside of
    the block what is no reason for that.

    Attributes:
        id: for Client.end_session.
        map: as it was when the session started.
        summary: None until the session has ended or was discarded.
    """

    def __init__(self, client: Client, session_id: str, map_info: Map) -> None:
        self._client = client
        self.id = session_id
        self.map = map_info
        self.summary: SessionSummary | None = None

    def localize(
        self,
        view: View,
        *,
        gravity: Gravity | None = None,
        prior: Prior | None = None,
        options: QueryOptions = _DEFAULT,
    ) -> Localization:
        """Where was this seen? The query counts in the statistics of the segment that answers."""
        return self._client._localize_in_session(self.id, view, gravity, prior, options)

    def localize_photo(
        self,
        photo: Photo,
        camera: Camera,
        *,
        gravity: Gravity | None = None,
        camera_from_body: Floats | None = None,
        prior: Prior | None = None,
        options: QueryOptions = _DEFAULT,
    ) -> Localization:
        """As `localize`, with the features that the map needs found in the photo (see `make_view`)."""
        view = make_view(photo, camera, self.map, camera_from_body=camera_from_body)
        return self.localize(view, gravity=gravity, prior=prior, options=options)

    def end(self) -> SessionSummary:
        """Ends the session: its queries count. Idempotent."""
        self.summary = self._client.end_session(self.id)
        return self.summary

    def discard(self) -> SessionSummary:
        """Ends the session so that none of its queries counts."""
        self.summary = self._client.end_session(self.id, discard=True)
        return self.summary

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.summary is not None:
            return
        if error is None:
            self.end()
            return
        try:
            self.discard()
        except MaplocError as failed:  # the first exception is the one to be seen
            error.add_note(f"session {self.id} could not be discarded: {failed}")
