"""Joint lists from surveys, stereonet programs and point clouds, with one joint a row.

`columns` has the names of columns and reads preambles, `tables` splits files and frames into rows of cells, `planes`
and `oriented_core` compute planes from cells, `reading` reads the joints of the rows.
"""

from slopekit.design.survey.joint_list import JointList, MeasuredJoint
from slopekit.design.survey.reading import read_frame, read_joints, read_joints_text

__all__ = ["JointList", "MeasuredJoint", "read_frame", "read_joints", "read_joints_text"]
