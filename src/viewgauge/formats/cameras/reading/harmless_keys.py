"""Keys that have no influence on where the camera shows a point in its own, unrectified image; each with the reason.

A key is harmless by its name, or by a word in its name. A word in a name counts only where the name has no word of the
projection (:data:`_OF_THE_PROJECTION`), so that an unknown key of a lens is never taken for harmless.
"""

from __future__ import annotations

import re

from .key_names import plain_name

__all__ = ["HARMLESS_NAMES", "HARMLESS_WORDS", "harmless_reason"]

_RECTIFIED = "of the rectified image; coordinates here are those of the image as the camera gives it"
_POSE = "where the camera stands, which is not part of its calibration here"
_TARGET = "the target that the calibration was made with"
_QUALITY = "how well the calibration fitted; its uncertainty is read from the keys of covariance only"
_SAYS_WHO = "who, when and with what the calibration was made"
_DATA = "the calibration's input, not its result"
_NAMES = "the name of the camera, of a frame or of a topic"
_FLAGS = "which coefficients were fitted; their values stand in the file"
_ACQUISITION = "how images are taken, not where the lens shows points"
_IN_MM = "a length in mm of lens or sensor; the focal length in px says what counts"
_OTHER_PARTS = "options of the program that uses the camera"
_DEPTH = "of a depth sensor, not of the image"


def _words(text: str) -> list[str]:
    return text.split()


HARMLESS_NAMES: dict[str, str] = {
    **dict.fromkeys(
        _words("r p r1 r2 p1 p2 q rect rectification projection projectionmatrix proj"),
        _RECTIFIED,
    ),
    **dict.fromkeys(
        _words(
            "rectificationmatrix rleft rright pleft pright newcameramatrix newcameramtx newk newmtx newmatrix roi1 "
            "roi2 optimalcameramatrix optimalmatrix newcammatrix disparitytodepth rectificationrotation dorectify "
            "validroi validpixroi1 validpixroi2 kinv invk inversecameramatrix undistortedcameramatrix"
        ),
        _RECTIFIED,
    ),
    **dict.fromkeys(
        _words(
            "t tvec rvec e f essential fundamental essentialmatrix fundamentalmatrix e1 f1 om rot trans stereo "
            "baseline tcncnm1 tcamimu timeshiftcamimu tbc tbs timucam tcw twc"
        ),
        _POSE,
    ),
    **dict.fromkeys(
        _words(
            "name label id cameraid cameraname camname frameid header frame seq stamp rostopic topic camoverlaps "
            "camera childframeid sensorid cameraindex camidx device devicename cameraserial comment comments note "
            "notes description remark remarks title"
        ),
        _NAMES,
    ),
    **dict.fromkeys(
        _words(
            "flags flagvalue calibrationflags fixaspectratio aspectratio assumezerotangentdist zerotangentdist "
            "fixprincipalpointatthecenter fixprincipalpoint fixk1 fixk2 fixk3 fixk4 fixk5 estimateskew "
            "numradialdistortioncoefficients estimatetangentialdistortion numradialcoeffs flag"
        ),
        _FLAGS,
    ),
    **dict.fromkeys(
        _words("err rms rmse mre mse error stddev ret retval success score cost status perviewerrors perviewerror"),
        _QUALITY,
    ),
    **dict.fromkeys(
        _words(
            "nframes nrofframes numframes numimages nimages framecount images imagelist imagenames objpoints "
            "imgpoints objectpoints worldpoints validintrinsicsregion optimizationinputs icamintrinsics extrinsics "
            "reprojectederrors worldunits keypoints"
        ),
        _DATA,
    ),
    **dict.fromkeys(
        _words(
            "sensortype ratehz rate fps framerate frequency hz rgb isrgb exposure exposuretime gain bitdepth format"
        ),
        _ACQUISITION,
    ),
    **dict.fromkeys(
        _words(
            "focallengthmm lensfocallength lensfocallengthmm nominalfocallength nominalfocallengthmm sensorwidthmm "
            "sensorheightmm sensorsizemm pixelsize pixelsizemm pixelsizeum pixelpitch pixelpitchum pixelpitchmm "
            "sensorsize"
        ),
        _IN_MM,
    ),
    **dict.fromkeys(
        _words("orbextractor viewer imu system loopclosing stereo bf thdepth depthmapfactor"), _OTHER_PARTS
    ),
    **dict.fromkeys(_words("depthscale depthunits depthfactor rgbtodepth depthtocolor"), _DEPTH),
    **dict.fromkeys(_words("version fileversion formatversion schema xmlns encoding nodes"), _SAYS_WHO),
}
"""By the name as :func:`~.key_names.plain_name` gives it."""

HARMLESS_WORDS: dict[str, str] = {
    r"time|date|stamp|operator|author|software|tool|version|serial|manufactur|vendor|firmware|hostname|url": _SAYS_WHO,
    r"file|path|folder|directory": _SAYS_WHO,
    r"board|pattern|square|checker|chess|charuco|aruco|marker|target|apriltag|circlegrid|gridpoint|gridsize": _TARGET,
    r"reproj|error|rms|residual|uncertaintynote": _QUALITY,
    r"extrinsic|rvec|tvec|rotation|translation|pose|transform|baseline|quaternion|position|imu": _POSE,
    r"imagepoint|objectpoint|framesused|numberofimages|imagefiles|worldpoint|detectedkeypoints": _DATA,
    r"rectif": _RECTIFIED,
}
"""By a word (a regular expression) in the name."""

_OF_THE_PROJECTION = re.compile(
    r"dist(?!ance|rib)|intrins|skew|focal|princip|binning|decimat|crop|(?<!grid)offset|scale|radial|tangent|coef|model|"
    r"lens|fov|pixel|sensor(?!id|serial|name)|mirror|zoom|tilt|shutter|delay|aspect|fisheye|width|height|resol"
)


def harmless_reason(key: str) -> str | None:
    """Why a key has no influence on the image; None where that is not known."""
    name = plain_name(key)
    if name in HARMLESS_NAMES:
        return HARMLESS_NAMES[name]
    if _OF_THE_PROJECTION.search(name):
        in_board = re.match(
            r"(board|pattern|square|marker|target|checkerboard|chessboard)(width|height|size|scale)", name
        )
        return _TARGET if in_board else None
    if re.fullmatch(
        r"t[a-z]?(?:c|cam|camera|imu|b|w|body|world)?\d?(?:c|cam|camera|imu|b|w|body|world|left|right)\d?", name
    ):
        return _POSE
    return next((reason for words, reason in HARMLESS_WORDS.items() if re.search(words, name)), None)
