"""Joint lists as surveys, stereonet programs and point clouds write them: one joint a row.

`columns` holds what columns are called and reads what stands above them, `tables` makes rows of cells of a file or
frame, `planes` and `oriented_core` make planes of cells, `reading` makes joints of the rows.
"""

from slopekit.design.survey.joint_list import JointList, MeasuredJoint
from slopekit.design.survey.reading import read_frame, read_joints, read_joints_text

__all__ = ["JointList", "MeasuredJoint", "read_frame", "read_joints", "read_joints_text"]
