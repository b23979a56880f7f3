"""Where was this photo taken?

usage: photo.py SERVER MAP PHOTO CAMERAS_TXT [DOWN_X DOWN_Y DOWN_Z]
DOWN: gravity in the camera's frame (x right, y down, z forward); an upright camera has 0 1 0.
"""

import sys

import maploc

if len(sys.argv) not in (5, 8):
    sys.exit(__doc__)
server, map_name, photo, cameras_txt = sys.argv[1:5]
down = [float(number) for number in sys.argv[5:]]

camera = maploc.Camera.from_colmap(cameras_txt)
gravity = maploc.Gravity.down(down) if down else None
with maploc.Client(server) as client:
    answer = client.localize_photo(map_name, photo, camera, gravity=gravity)

if answer.pose is None:  # a normal answer: nothing that a robot may trust
    sys.exit(f"not localized: {answer.outcome.name}, {answer.evidence.points.matches} points matched")
print("position", *answer.pose.position_in_map)
print("orientation (x y z w)", *answer.pose.orientation_xyzw)
print("confidence", answer.confidence, "inliers", answer.evidence.points.inliers)
