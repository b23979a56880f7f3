"""Photos as grey images, and what is found in them."""

import pathlib
import tempfile
import unittest

import cv2
import maploc
import numpy as np
import numpy.typing as npt
from maploc.photo import as_gray

SIFT = maploc.DescriptorKind("sift_root_u8", 128, maploc.Metric.L2_U8)
ORB = maploc.DescriptorKind("orb", 32, maploc.Metric.HAMMING)


def painting(seed: int, height: int = 240, width: int = 320) -> npt.NDArray[np.uint8]:
    """Blobs and a few straight edges."""
    random = np.random.default_rng(seed)
    photo = cv2.GaussianBlur(random.integers(0, 255, (height, width), np.uint8), (0, 0), 2)
    photo[height // 4 : height // 2, width // 4 : width // 2] = 255
    return photo


class PhotoTest(unittest.TestCase):
    """Files in a folder of their own."""

    def setUp(self) -> None:
        """Makes the folder."""
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_sixteen_bits_give_the_eight_in_use(self) -> None:
        grey = painting(1)
        path = self.folder / "wide.png"
        cv2.imwrite(str(path), grey.astype(np.uint16) << 4)  # a sensor of 12 bits
        np.testing.assert_array_equal(maploc.load_gray(path), grey)

    def test_a_cut_photo_is_refused(self) -> None:
        for name in ("a.jpg", "a.png"):
            path = self.folder / name
            cv2.imwrite(str(path), painting(1))
            content = path.read_bytes()
            path.write_bytes(content + b"what a phone appends")
            self.assertEqual(maploc.load_gray(path).shape, (240, 320))
            for length in (len(content) - 1, len(content) // 2, 30):
                path.write_bytes(content[:length])
                with self.assertRaises(maploc.MaplocError) as raised:
                    maploc.load_gray(path)
                self.assertEqual((raised.exception.reason, raised.exception.field), ("TRUNCATED_IMAGE", str(path)))

    def test_what_is_no_photo_is_refused(self) -> None:
        (self.folder / "text.png").write_text("no picture")
        for photo in (self.folder / "text.png", self.folder / "absent.png", np.zeros((4, 4, 4), np.uint8)):
            with self.assertRaises(maploc.MaplocError):
                as_gray(photo)
        with self.assertRaisesRegex(maploc.MaplocError, "float64"):
            as_gray(np.zeros((4, 4)))

    def test_features_turn_with_the_photo(self) -> None:
        """An offset of a fraction of a pixel would stay where it is when the photo is turned by 180 degrees."""
        photo = painting(3)
        for kind in (SIFT, ORB):
            found, turned = (
                maploc.detect_points(p, kind).keypoints_pixels for p in (photo, np.ascontiguousarray(photo[::-1, ::-1]))
            )
            back = np.array([319, 239]) - turned
            distances = np.linalg.norm(found[:, None] - back[None], axis=2)
            pairs = distances.argmin(axis=1)
            close = distances.min(axis=1) < 1
            self.assertGreater(int(close.sum()), 50)
            offset = np.median(found[close] - back[pairs[close]], axis=0) / 2
            self.assertLess(float(np.abs(offset).max()), 0.06, (kind.name, offset))

    def test_root_sift_rows_have_their_kinds_length(self) -> None:
        descriptors = maploc.detect_points(painting(4), SIFT).descriptors.astype(float)
        np.testing.assert_allclose(np.linalg.norm(descriptors, axis=1), 512, rtol=0.01)

    def test_a_large_photo_is_reduced_and_told_in_its_own_pixels(self) -> None:
        photo = cv2.resize(painting(5), (3200, 2400), interpolation=cv2.INTER_CUBIC)
        points = maploc.detect_points(photo, SIFT, max_points=50).keypoints_pixels
        self.assertTrue((points >= 0).all() and (points[:, 0] < 3200).all() and (points[:, 1] < 2400).all())
        self.assertGreater(float(points[:, 0].max()), 2400)

    def test_lines_lie_on_the_edges(self) -> None:
        self.assertTrue(maploc.has_lines(), "Debian's OpenCV has line_descriptor")
        photo = np.full((240, 320), 60, np.uint8)
        photo[60:180, 80:240] = 200
        lines = maploc.detect_lines(photo)
        self.assertEqual(lines.descriptors.shape, (4, 32))
        for x0, y0, x1, y1 in lines.segments_pixels.tolist():
            on_side = min(abs(x - edge) for x in (x0, x1) for edge in (79.5, 239.5)) if abs(x1 - x0) < 1 else 9
            on_level = min(abs(y - edge) for y in (y0, y1) for edge in (59.5, 179.5)) if abs(y1 - y0) < 1 else 9
            self.assertLess(min(on_side, on_level), 0.3, (x0, y0, x1, y1))

    def test_where_nothing_can_be_found_there_are_no_features(self) -> None:
        for photo in (np.zeros((8, 8), np.uint8), np.zeros((240, 320), np.uint8)):
            self.assertEqual(maploc.detect_points(photo, SIFT).keypoints_pixels.shape, (0, 2))
            self.assertEqual(maploc.detect_points(photo, ORB).descriptors.shape, (0, 32))
            self.assertEqual(maploc.detect_lines(photo).segments_pixels.shape, (0, 4))

    def test_a_kind_without_a_detector_is_refused_with_the_cure(self) -> None:
        with self.assertRaises(maploc.MaplocError) as raised:
            maploc.detect_points(painting(1), maploc.DescriptorKind("unit128", 128, maploc.Metric.L2_U8))
        self.assertEqual(raised.exception.reason, "NO_DETECTOR")
        self.assertIn("Points", raised.exception.cure)


if __name__ == "__main__":
    unittest.main()
