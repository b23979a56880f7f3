"""What a user sees when something is wrong: code, reason, field and cure of a real server's refusals."""

import unittest
import unittest.mock

import maploc
import numpy as np
from room_test_case import RoomTestCase

SIFT = maploc.DescriptorKind("sift_root_u8", 128, maploc.Metric.L2_U8)


class ErrorsTest(RoomTestCase):
    """Refusals of the server, and of gRPC."""

    def test_an_unknown_map_is_named(self) -> None:
        error = self.refusal("attic", maploc.View(self.camera))
        self.assertEqual((error.code, error.reason), ("NOT_FOUND", "MAP_NOT_FOUND"))
        self.assertIn("attic", error.message)
        self.assertIn("Client.maps()", error.cure)
        self.assertIn(error.cure, str(error))

    def test_a_wrong_field_is_named(self) -> None:
        camera = maploc.Camera(maploc.CameraModel.PINHOLE, 640, 480, (0.0, 500, 320, 240))
        error = self.refusal("room", maploc.View(camera))
        self.assertEqual((error.code, error.reason), ("INVALID_ARGUMENT", "BAD_FOCAL_LENGTH"))
        self.assertEqual(error.field, "views[0].camera.params[0]")

    def test_descriptors_of_another_kind_are_refused(self) -> None:
        orb = maploc.DescriptorKind("orb", 32, maploc.Metric.HAMMING)
        points = maploc.Points(np.ones((1, 2), np.float32), np.ones((1, 32), np.uint8), orb)
        self.assertEqual(self.refusal("room", maploc.View(self.camera, points)).code, "FAILED_PRECONDITION")

    def test_sift_that_is_not_normalized_as_its_kind_is_refused_with_the_cure(self) -> None:
        points = maploc.Points(np.ones((1, 2), np.float32), np.full((1, 128), 200, np.uint8), SIFT)
        error = self.refusal("room", maploc.View(self.camera, points))
        self.assertEqual(error.reason, "DESCRIPTOR_SCALE")
        self.assertNotEqual(error.cure, "")

    def test_a_name_that_is_not_utf_8_is_refused(self) -> None:
        self.assertEqual(self.refusal("\udcff", maploc.View(self.camera)).reason, "NOT_UTF8")

    def test_a_server_that_is_not_there_is_unavailable(self) -> None:
        with maploc.Client("127.0.0.1:1") as nobody, self.assertRaises(maploc.MaplocError) as raised:
            nobody.maps()
        self.assertEqual((raised.exception.code, raised.exception.reason), ("UNAVAILABLE", "UNAVAILABLE"))
        self.assertIn("127.0.0.1:1", raised.exception.message)
        self.assertIn("is maploc-server running", str(raised.exception))

    def test_this_machine_is_reached_without_the_environments_proxy(self) -> None:
        with unittest.mock.patch.dict("os.environ", {"http_proxy": "http://127.0.0.1:1", "no_proxy": ""}):
            with maploc.Client(self.server.address) as client:
                self.assertEqual([found.name for found in client.maps()], ["room"])

    def refusal(self, map_name: str, view: maploc.View) -> maploc.MaplocError:
        """The error of a query that must fail."""
        with self.assertRaises(maploc.MaplocError) as raised:
            self.client.localize(map_name, view)
        return raised.exception


if __name__ == "__main__":
    unittest.main()
