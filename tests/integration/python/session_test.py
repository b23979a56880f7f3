"""Sessions count what was localized in them, unless they are left by an exception."""

import unittest

import maploc
from room_test_case import RoomTestCase


class SessionTest(RoomTestCase):
    """What a session leaves in the statistics of the map's segments."""

    def test_a_session_counts_its_queries_when_it_ends(self) -> None:
        queries, sessions = self.segment_counts()
        with self.client.session("room", "cart", {"season": "autumn"}) as session:
            for shot in self.shots:
                self.assertIs(session.localize_photo(shot.path, self.camera).outcome, maploc.Outcome.LOCALIZED)
        assert session.summary is not None
        self.assertEqual((session.summary.queries, session.summary.localized), (3, 3))
        self.assertEqual(self.segment_counts(), (queries + 3, sessions + 1))
        self.assertEqual(self.client.end_session(session.id), session.summary)
        self.assertEqual(self.segment_counts(), (queries + 3, sessions + 1), "a repeated end changed something")

    def test_an_exception_discards_the_session(self) -> None:
        for leave in (RuntimeError("the wheels slip"), KeyboardInterrupt()):
            before = self.segment_counts()
            with self.assertRaises(type(leave)) as raised:
                with self.client.session("room", "cart") as session:
                    session.localize_photo(self.shots[0].path, self.camera)
                    raise leave
            self.assertIs(raised.exception, leave)
            self.assertIsNotNone(session.summary)
            self.assertEqual(self.segment_counts(), before)

    def test_what_a_session_said_before_stays(self) -> None:
        with self.client.session("room", "cart") as session:
            session.localize_photo(self.shots[0].path, self.camera)
            self.assertEqual(session.discard().queries, 1)
        with self.assertRaises(maploc.MaplocError) as refused:
            session.localize_photo(self.shots[0].path, self.camera)
        self.assertEqual(refused.exception.reason, "SESSION_CLOSED")
        self.assertEqual(refused.exception.cure, "start a new one")

    def test_the_first_exception_is_seen_where_the_session_cannot_be_discarded(self) -> None:
        with self.assertRaisesRegex(RuntimeError, "the wheels slip") as raised:
            with self.client.session("room", "cart") as session:
                self.client.end_session(session.id)  # from now on it counts
                raise RuntimeError("the wheels slip")
        self.assertIn("could not be discarded", raised.exception.__notes__[0])


if __name__ == "__main__":
    unittest.main()
