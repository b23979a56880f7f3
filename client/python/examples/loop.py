"""Localizes each frame of a camera in one session, near the last answer first.

usage: loop.py SERVER MAP SOURCE CAMERAS_TXT
SOURCE: a camera's number, or what else cv2.VideoCapture opens: a video, a stream, photos (frames/%04d.jpg).
"""

import sys

import cv2
import numpy as np

import maploc

if len(sys.argv) != 5:
    sys.exit(__doc__)
server, map_name, source, cameras_txt = sys.argv[1:]
camera = maploc.Camera.from_colmap(cameras_txt)
frames = cv2.VideoCapture(int(source) if source.isdecimal() else source)

# Put your IMU's sample here, m/s^2 as the sensor tells it. This one is of a camera that is about level: it measures UP,
# which is -y of a camera's frame.
gravity = maploc.Gravity.from_accelerometer_at_rest([0, -9.81, 0], body_from_imu=np.eye(3), sigma_degrees=20)

with maploc.Client(server) as client, client.session(map_name, robot="loop-example") as session:
    prior = None
    try:
        while (frame := frames.read()[1]) is not None:
            answer = session.localize_photo(frame, camera, gravity=gravity, prior=prior)
            print(answer.outcome.name, answer.pose.position_in_map if answer.pose else "", flush=True)
            if answer.pose:
                prior = maploc.Prior(answer.pose.position_in_map, sigma=5.0)
    except KeyboardInterrupt:
        pass  # the usual end of a loop: what was localized counts
print(session.summary.localized if session.summary else 0, "frames localized")
