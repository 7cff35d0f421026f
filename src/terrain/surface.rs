//! Triangles with elevations: the streams that have them, and the triangles that are left out or refused.

pub(crate) use crate::counterclockwise::is_counterclockwise;
pub(crate) use spmesh_stream::check_surface as check_input;
