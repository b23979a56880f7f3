"""Localizes all photos of a folder in one session; one line of CSV a photo.

usage: folder.py SERVER MAP FOLDER CAMERAS_TXT
"""

import csv
import pathlib
import sys

import maploc

if len(sys.argv) != 5:
    sys.exit(__doc__)
server, map_name, folder, cameras_txt = sys.argv[1:]
camera = maploc.Camera.from_colmap(cameras_txt)
photos = [path for path in sorted(pathlib.Path(folder).iterdir()) if path.suffix.lower() in (".jpg", ".jpeg", ".png")]

table = csv.writer(sys.stdout)
table.writerow(["photo", "outcome", "confidence", "x", "y", "z", "qx", "qy", "qz", "qw"])
with maploc.Client(server) as client, client.session(map_name, robot="folder-example") as session:
    for path in photos:
        try:
            answer = session.localize_photo(path, camera)
        except maploc.MaplocError as error:
            if error.reason not in ("INVALID_FILE", "TRUNCATED_IMAGE", "SIZE_MISMATCH"):
                raise  # the others would fail alike: the session is discarded
            print(f"{path.name}: {error}", file=sys.stderr)
            continue
        pose = [*answer.pose.position_in_map, *answer.pose.orientation_xyzw] if answer.pose else [""] * 7
        table.writerow([path.name, answer.outcome.name, answer.confidence, *pose])
