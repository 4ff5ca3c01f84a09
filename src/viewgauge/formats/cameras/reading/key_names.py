"""The names under which programs write one and the same thing, compared without case, points, dashes and underscores.

One letter may be a matrix in one file and a coefficient in another (``k1``): the value decides, see :func:`is_matrix`.
"""

from __future__ import annotations

import re

__all__ = [
    "COEFFICIENT_NAMES",
    "DISTORTION",
    "FISHEYE_FLAG",
    "FOCAL_PAIR",
    "HEIGHT",
    "MATRIX",
    "MODEL",
    "PRINCIPAL_PAIR",
    "RADIAL",
    "SCALARS",
    "SIZE",
    "SIZE_ROWS_FIRST",
    "SKEW",
    "TANGENTIAL",
    "WIDTH",
    "is_matrix",
    "plain_name",
]


def plain_name(key: str) -> str:
    """A key without what programs write differently: ``camera_matrix``, ``cameraMatrix`` and ``Camera-Matrix``."""
    return re.sub(r"[^a-z0-9]", "", key.lower())


def is_matrix(value: object) -> bool:
    """Whether a value is a list, or a mapping with ``data``, and not a number."""
    return isinstance(value, list) or (isinstance(value, dict) and "data" in value)


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


MATRIX = _words(
    "cameramatrix cameramat cammatrix cammat matrix k kmatrix kmat mtx cameramtx mat cameraintrinsicmatrix "
    "intrinsicmatrix intrinsicmat intrinsic intrinsics intrinsicparameters intrinsicparams intrinsicsmatrix "
    "intrinsicsparameters projectionparameters "
    "projectionparams cameraintrinsics cameraintrinsic calibrationmatrix m calibmatrix intrinsicsvector"
)
DISTORTION = _words(
    "distortioncoefficients distortioncoefficents distortioncoefficient distortioncoeffs distortioncoeff "
    "distortioncoefs distortioncoef distcoeffs distcoeff distcoefs distcoef distcoefficients dist distortion "
    "distortions d dvector distortionparameters distortionparams distortionparam distortionvector distvector distvec "
    "distortionmatrix distmatrix distmat distorsion distorsioncoefficients distorsioncoeffs distorsions "
    "lensdistortion lensdistortioncoefficients coeffs coefficients coefs distparams kc kd"
)
MODEL = _words(
    "distortionmodel distortiontype distmodel disttype lensmodel lenstype model cameramodel cameratype cammodel type "
    "projection projectionmodel projectiontype lensdistortionmodel modelname modeltype distortionmodelname"
)
FISHEYE_FLAG = _words("fisheyemodel fisheye isfisheye usefisheye calibratefisheye")
WIDTH = _words("imagewidth width w imgwidth imwidth cols columns resolutionx resx sizex framewidth")
HEIGHT = _words("imageheight height h imgheight imheight rows resolutiony resy sizey frameheight")
SIZE = _words(
    "imagesize imgsize imsize size resolution imageresolution dim dims imagedim imagedims dimensions imagedimensions "
    "sensorresolution cameraresolution imgresolution imagerdimensions imagersize calibrationresolution wh imagewh "
    "framesize calibimagesize calibrationimagesize"
)
SIZE_ROWS_FIRST = _words("shape imageshape imgshape imshape hw imagehw")
FOCAL_PAIR = _words("focallength focallengths focal fxfy f fc focallengthpx focallengthpixels")
PRINCIPAL_PAIR = _words(
    "principalpoint principal principlepoint cxcy opticalcenter opticalcentre cc pp principalpointpx c center"
)
SKEW = _words("skew s gamma axisskew alphac skewcoefficient shear")
SCALARS = {
    "fx": _words("fx focallengthx focalx fu flx alphax focallengthpxx"),
    "fy": _words("fy focallengthy focaly fv fly alphay focallengthpxy"),
    "cx": _words("cx ppx u0 cu principalpointx principalx centerx opticalcenterx pox x0"),
    "cy": _words("cy ppy v0 cv principalpointy principaly centery opticalcentery poy y0"),
}
COEFFICIENT_NAMES = (
    *("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    *("s1", "s2", "s3", "s4", "taux", "tauy"),
)
"""In the order of OpenCV."""
RADIAL = _words("radialdistortion radialdistortioncoefficients radial radialcoefficients")
TANGENTIAL = _words("tangentialdistortion tangentialdistortioncoefficients tangential tangentialcoefficients")
