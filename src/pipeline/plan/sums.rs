//! Whether the reports of all nodes account for every point.

use super::plan::Plan;
use super::report::NodeReport;
use spmesh_base::error::{Error, Result};

/// Checks that every point that the files state was in the box of one leaf, and became a vertex, was merged, or was
/// dropped by a filter there.
///
/// # Errors
/// Malformed, if points are missing or counted twice; the first file of which this is so is named.
pub fn check_sums(plan: &Plan, reports: &[NodeReport]) -> Result<()> {
    let mut found = vec![0u64; plan.files.len()];
    for count in reports.iter().flat_map(|report| &report.files) {
        if let Some(points) = found.get_mut(count.file as usize) {
            *points += count.points;
        }
    }
    if let Some((file, found)) = plan.files.iter().zip(&found).find(|(file, found)| file.points != **found) {
        let stated = file.points;
        let message = format!(
            "states {stated} points, but the leaves found {found} of it: its header or its index is wrong (make its \
             header or index anew, and plan again)"
        );
        return Err(Error::malformed(message).of_input(&file.path));
    }
    for report in reports.iter().filter(|report| report.stage == 0) {
        let counted: u64 = report.files.iter().map(|count| count.points).sum();
        if counted != report.points + report.dropped {
            return Err(Error::malformed(format!(
                "node {} found {counted} points, but triangulated {} and dropped {}",
                report.node, report.points, report.dropped
            )));
        }
    }
    let sum = |count: fn(&NodeReport) -> u64| reports.iter().map(count).sum::<u64>();
    let [points, merged, vertices] = [sum(|it| it.points), sum(|it| it.merged), sum(|it| it.vertices)];
    if points != merged + vertices {
        return Err(Error::malformed(format!(
            "{points} points were triangulated, but {vertices} are vertices and {merged} were merged"
        )));
    }
    Ok(())
}
