"""Between this package's values and the messages of maploc.v1. An answer that breaks its contract is an error, never
a pose."""

import enum
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from maploc import answer, query
from maploc.arrays import Floats, matrix_from_quaternion, numbers, quaternion_from_matrix
from maploc.camera import Camera
from maploc.errors import MaplocError, invalid
from maploc.gravity import Gravity
from maploc.v1 import localization_service_pb2, map_service_pb2, types_pb2

Enum = TypeVar("Enum", bound=enum.IntEnum)


@contextmanager
def sent_text() -> Iterator[None]:
    """Around what sets strings of a request: they must be UTF-8."""
    try:
        yield
    except (UnicodeError, ValueError) as error:
        raise MaplocError("INVALID_ARGUMENT", "NOT_UTF8", f"a name cannot be sent as UTF-8 ({error})") from None


def localize_request(
    view: query.View, gravity: Gravity | None, prior: query.Prior | None, options: query.QueryOptions
) -> localization_service_pb2.LocalizeRequest:
    """Without map and session."""
    request = localization_service_pb2.LocalizeRequest(views=[_view(view)])
    with sent_text():
        request.request_id = options.request_id
    request.capture_unix_nanos = options.capture_unix_nanos
    request.include_matches = options.include_matches
    request.map_version = options.map_version
    request.refinement = localization_service_pb2.RefinementMode.ValueType(options.refinement)
    if options.strategy is not None:
        request.strategy = types_pb2.Strategy.ValueType(options.strategy)
    if options.max_error_pixels is not None:
        request.max_error_pixels = options.max_error_pixels
    if gravity is not None:
        request.gravity.direction_in_body.CopyFrom(_vector(gravity.down_in_body))
        request.gravity.sigma_radians = gravity.sigma_radians
    if prior is not None:
        request.prior.position_in_map.CopyFrom(_vector(prior.position_in_map))
        request.prior.position_sigma = prior.sigma
    return request


def _view(view: query.View) -> localization_service_pb2.View:
    message = localization_service_pb2.View(camera=_camera(view.camera))
    if view.camera_from_body is not None:
        x, y, z, w = quaternion_from_matrix(view.camera_from_body[:3, :3])
        message.camera_from_body.rotation.CopyFrom(types_pb2.Quaternion(x=x, y=y, z=z, w=w))
        message.camera_from_body.translation.CopyFrom(_vector(view.camera_from_body[:3, 3]))
    if view.points is not None:
        message.points.CopyFrom(_features(view.points.keypoints_pixels, view.points))
    if view.lines is not None:
        message.lines.CopyFrom(_features(view.lines.segments_pixels, view.lines))
    return message


def _camera(camera: Camera) -> types_pb2.Camera:
    return types_pb2.Camera(
        model=types_pb2.CameraModel.ValueType(camera.model),
        width_pixels=camera.width_pixels,
        height_pixels=camera.height_pixels,
        params=camera.params,
    )


def _features(
    coordinates: npt.NDArray[np.float32], features: query.Points | query.Lines
) -> localization_service_pb2.Features:
    kind = features.kind
    return localization_service_pb2.Features(
        coordinates_pixels=coordinates.ravel().tolist(),
        descriptors=features.descriptors.tobytes(),
        descriptor_kind=types_pb2.DescriptorKind(
            name=kind.name,
            bytes_count=kind.bytes_count,
            metric=types_pb2.DescriptorMetric.ValueType(kind.metric),
        ),
    )


def _vector(values: Floats) -> types_pb2.Vector3:
    return types_pb2.Vector3(x=values[0], y=values[1], z=values[2])


@contextmanager
def _received() -> Iterator[None]:
    """Around what reads an answer: a fault in it is the server's."""
    try:
        yield
    except MaplocError as error:
        message = f"the server's answer breaks its contract: {error.message}"
        raise MaplocError("INTERNAL", "INTERNAL", message) from None


def localization_of(response: localization_service_pb2.LocalizeResponse, view: query.View) -> answer.Localization:
    """The answer to a query with this view."""
    with _received():
        outcome = _enum(answer.Outcome, response.outcome, "outcome")
        points = 0 if view.points is None else len(view.points.keypoints_pixels)
        lines = 0 if view.lines is None else len(view.lines.segments_pixels)
        return answer.Localization(
            outcome=outcome,
            pose=_pose(response, outcome),
            confidence=response.confidence,
            map_version=response.map_version,
            segment=response.segment_id,
            evidence=_evidence(response),
            times=_times(response.times),
            request_id=response.request_id,
            capture_unix_nanos=response.capture_unix_nanos,
            point_matches=_matches("point_matches", response.point_matches, points),
            line_matches=_matches("line_matches", response.line_matches, lines),
        )


def _pose(response: localization_service_pb2.LocalizeResponse, outcome: answer.Outcome) -> answer.Pose | None:
    localized = outcome is answer.Outcome.LOCALIZED
    if localized != response.HasField("map_from_body"):
        invalid("map_from_body", "must come with LOCALIZED and with nothing else")
    if not localized:
        return None
    rotation, translation = response.map_from_body.rotation, response.map_from_body.translation
    return answer.Pose(
        position_in_map=numbers("map_from_body.translation", [translation.x, translation.y, translation.z], (3,)),
        orientation_xyzw=_orientation("map_from_body.rotation", rotation),
        covariance=_covariance(response.covariance),
    )


def _covariance(values: Sequence[float]) -> Floats:
    return numbers("covariance", np.reshape(numbers("covariance", list(values), (36,)), (6, 6)), (6, 6))


def _orientation(field: str, q: types_pb2.Quaternion) -> Floats:
    # In the order in which the C++ client adds, so that both have the same bits.
    norm = math.sqrt((q.x * q.x + q.z * q.z) + (q.y * q.y + q.w * q.w))
    if not abs(norm - 1) <= 1e-3:
        invalid(field, f"has the norm {norm:g}")
    return numbers(field, [q.x / norm, q.y / norm, q.z / norm, q.w / norm], (4,))


def _evidence(response: localization_service_pb2.LocalizeResponse) -> answer.Evidence:
    focal = None
    if response.HasField("focal_length_scale"):
        focal = answer.FocalScale(response.focal_length_scale, response.focal_length_scale_sigma)
    return answer.Evidence(
        points=_counts(response.points),
        usable_lines=_counts(response.usable_lines),
        vertical_lines=_counts(response.vertical_lines),
        strategy=_enum(query.Strategy, response.strategy, "strategy"),
        strategy_source=_enum(answer.StrategySource, response.strategy_source, "strategy_source"),
        fell_back=response.fell_back,
        iterations=response.iteration_count,
        predicted_success=response.predicted_success,
        inlier_rms_pixels=response.inlier_rms_pixels,
        gravity_disagreement_radians=response.gravity_disagreement_radians,
        gravity_rejected=response.gravity_rejected,
        focal_scale=focal,
    )


def _counts(counts: types_pb2.FeatureCounts) -> answer.FeatureCounts:
    return answer.FeatureCounts(counts.match_count, counts.inlier_count)


def _times(times: localization_service_pb2.StageTimes) -> answer.StageTimes:
    return answer.StageTimes(
        times.convert_ms,
        times.retrieval_ms,
        times.matching_ms,
        times.ransac_ms,
        times.refinement_ms,
        times.total_ms,
    )


def _matches(field: str, matches: localization_service_pb2.FeatureMatches, feature_count: int) -> answer.FeatureMatches:
    indices = np.array(matches.feature_indices, np.int32)
    inliers = np.frombuffer(matches.inliers, np.uint8).astype(np.bool_)
    if len(inliers) != len(indices):
        invalid(f"{field}.inliers", "their count differs from the indices'")
    if len(indices) and not 0 <= indices.min() <= indices.max() < feature_count:
        invalid(f"{field}.feature_indices", "name a feature that was not sent")
    return answer.FeatureMatches(indices, inliers)


def summary_of(response: localization_service_pb2.EndSessionResponse) -> answer.SessionSummary:
    """What a session did."""
    with _received():
        changes = [
            answer.SegmentChange(
                change.segment_id,
                change.query_count,
                change.localized_count,
                _enum(query.Strategy, change.strategy_before, "strategy_before"),
                _enum(query.Strategy, change.strategy_after, "strategy_after"),
            )
            for change in response.segments
        ]
        end = _enum(answer.SessionEnd, response.end, "end")
        return answer.SessionSummary(end, response.query_count, response.localized_count, tuple(changes))


def map_of(message: map_service_pb2.Map) -> answer.Map:
    """One map."""
    with _received():
        source = message.map_from_source
        matrix = np.eye(4)
        orientation = _orientation("map_from_source.rotation", source.rotation)
        matrix[:3, :3] = source.scale * matrix_from_quaternion(orientation)
        matrix[:3, 3] = source.translation.x, source.translation.y, source.translation.z
        return answer.Map(
            name=message.name,
            version=message.version,
            metric=message.metric,
            map_from_source=numbers("map_from_source", matrix, (4, 4)),
            point_kind=_kind(message.point_descriptor_kind),
            line_kind=_kind(message.line_descriptor_kind),
            segments=message.segment_count,
            points=message.point_count,
            lines=message.line_count,
            usable_lines=message.usable_line_count,
        )


def _kind(kind: types_pb2.DescriptorKind) -> query.DescriptorKind | None:
    if not kind.name:
        return None
    return query.DescriptorKind(kind.name, kind.bytes_count, _enum(query.Metric, kind.metric, "metric"))


def segment_of(message: map_service_pb2.Segment) -> answer.Segment:
    """One segment."""

    def ratio(name: str) -> float | None:
        return float(getattr(message, name)) if message.HasField(name) else None

    with _received():
        return answer.Segment(
            segment=message.segment_id,
            points=message.point_count,
            lines=message.line_count,
            usable_lines=message.usable_line_count,
            strategy=_enum(query.Strategy, message.strategy, "strategy"),
            strategy_source=_enum(answer.StrategySource, message.strategy_source, "strategy_source"),
            point_inlier_ratio=ratio("point_inlier_ratio"),
            line_inlier_ratio=ratio("line_inlier_ratio"),
            sessions=message.session_count,
            queries=message.query_count,
            localized=message.localized_count,
        )


def _enum(kind: type[Enum], value: int, field: str) -> Enum:
    try:
        return kind(value)
    except ValueError:
        invalid(field, f"{value} is no {kind.__name__} that this client knows; is it older than the server?")
