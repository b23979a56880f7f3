"""Photos of the painted room through a real server: poses, matches, and the same answers as the C++ client's."""

import unittest

import cv2
import maploc
import numpy as np
from room_test_case import RoomTestCase
from running_server import run


class LocalizeTest(RoomTestCase):
    """Outside of sessions."""

    kinds = {"room": "sift_root_u8", "orb_room": "orb"}

    def test_a_photo_is_localized_where_it_was_taken(self) -> None:
        for shot in self.shots:
            gravity = maploc.Gravity.down(shot.down_in_camera)
            answer = self.client.localize_photo("room", shot.path, self.camera, gravity=gravity)
            assert answer.pose is not None, answer.outcome
            self.assertIs(answer.outcome, maploc.Outcome.LOCALIZED)
            np.testing.assert_allclose(answer.pose.position_in_map, shot.position_in_room, atol=0.02)
            room_from_camera = answer.pose.map_from_body
            np.testing.assert_allclose(room_from_camera[:3, :3].T, shot.camera_from_room[:, :3], atol=0.01)
            self.assertLess(answer.evidence.gravity_disagreement_radians, 0.02)
            sigma = np.sqrt(np.trace(answer.pose.covariance[:3, :3]))
            self.assertTrue(0 < sigma < 0.1, sigma)

    def test_an_array_is_localized_as_its_file(self) -> None:
        path = self.shots[0].path
        grey = maploc.load_gray(path)
        of_file = self.client.localize_photo("room", path, self.camera)
        for photo in (grey, cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), grey.astype(np.uint16) << 4):
            answer = self.client.localize_photo("room", photo, self.camera)
            assert answer.pose is not None and of_file.pose is not None
            np.testing.assert_array_equal(answer.pose.map_from_body, of_file.pose.map_from_body)

    def test_the_body_is_where_camera_from_body_says(self) -> None:
        shot = self.shots[0]
        # A robot's body, x forward, z up, a metre below its camera.
        camera_from_body = np.array([[0, -1, 0, 0], [0, 0, -1, 1.0], [1, 0, 0, 0], [0, 0, 0, 1.0]])
        up_in_imu = camera_from_body[:3, :3].T @ -shot.down_in_camera
        gravity = maploc.Gravity.from_accelerometer_at_rest(9.81 * up_in_imu, body_from_imu=np.eye(3))
        answer = self.client.localize_photo(
            "room", shot.path, self.camera, gravity=gravity, camera_from_body=camera_from_body
        )
        assert answer.pose is not None
        self.assertLess(answer.evidence.gravity_disagreement_radians, 0.05)
        room_from_camera = np.linalg.inv(np.vstack([shot.camera_from_room, [0, 0, 0, 1]]))
        np.testing.assert_allclose(answer.pose.map_from_body, room_from_camera @ camera_from_body, atol=0.02)

    def test_gravity_upside_down_is_told(self) -> None:
        shot = self.shots[0]
        answer = self.client.localize_photo(
            "room", shot.path, self.camera, gravity=maploc.Gravity.down(-shot.down_in_camera)
        )
        self.assertGreater(answer.evidence.gravity_disagreement_radians, 3.0)
        self.assertTrue(answer.evidence.gravity_rejected or answer.pose is None)

    def test_matches_are_of_the_features_that_were_sent(self) -> None:
        view = maploc.make_view(self.shots[0].path, self.camera, self.client.map("room"))
        options = maploc.QueryOptions(include_matches=True, request_id="q-1", capture_unix_nanos=123)
        answer = self.client.localize("room", view, options=options)
        self.assertEqual((answer.request_id, answer.capture_unix_nanos), ("q-1", 123))
        self.assertGreaterEqual(int(answer.point_matches.inliers.sum()), 100)
        self.assertEqual(len(answer.point_matches.inliers), len(answer.point_matches.feature_indices))

    def test_another_place_has_no_pose(self) -> None:
        noise = np.random.default_rng(7).integers(0, 255, (480, 640), np.uint8)
        answer = self.client.localize_photo("room", cv2.GaussianBlur(noise, (0, 0), 2), self.camera)
        self.assertIsNot(answer.outcome, maploc.Outcome.LOCALIZED)
        self.assertIsNone(answer.pose)

    def test_the_answer_is_the_c_plus_plus_clients_to_the_bit(self) -> None:
        for name in self.kinds:
            for shot in self.shots:
                expected = run(
                    *("maploc", "localize", "--server", self.server.address, "--map", name, "--image", str(shot.path)),
                    *("--camera", str(self.folder / "model" / "cameras.txt")),
                )
                answer = self.client.localize_photo(name, shot.path, self.camera)
                assert answer.pose is not None
                self.assertEqual(expected["outcome"], "LOCALIZED")
                pose = expected["map_from_body"]
                self.assertEqual(answer.pose.position_in_map.tolist(), [pose["translation"][axis] for axis in "xyz"])
                self.assertEqual(answer.pose.orientation_xyzw.tolist(), [pose["rotation"][axis] for axis in "xyzw"])
                self.assertEqual(answer.pose.covariance.ravel().tolist(), pose["covariance"])


if __name__ == "__main__":
    unittest.main()
