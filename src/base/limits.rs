//! All limits of inputs in one place, so that no input makes a reader allocate without bound.

use crate::error::{Error, ErrorKind, Result, counted};

/// Longest header body of a stream, in bytes.
pub const HEADER_BODY_MAX: usize = 1 << 20;

/// Longest name and version of the program that wrote a stream, in bytes.
pub const PRODUCER_LEN_MAX: usize = (1 << 16) - 1;

/// Longest coordinate reference system taken from an input, in bytes: a header body must hold it beside its
/// fixed fields and the producer.
pub const CRS_LEN_MAX: usize = HEADER_BODY_MAX - (1 << 12);

/// Longest payload of a stream block, in bytes.
pub const BLOCK_PAYLOAD_MAX: usize = 1 << 20;

/// Most words of one cell of four dimensions: 8 GB. The cells that one block completes then have fewer than
/// 2^32 words in all.
pub const CELL_WORDS_MAX: u64 = 1 << 31;

/// Highest degree of configurations in a stream: an interior set then fits a block, and a line of a text
/// twin.
pub const CONFIGURATION_DEGREE_MAX: u32 = 1 << 12;

/// Most segments of a constrained mesh: sides of triangles name them in 32 bits.
pub const SEGMENTS_MAX: u64 = 1 << 32;

/// Longest manifest of a mesh in parts, in bytes: a million parts.
pub const MANIFEST_LEN_MAX: u64 = 1 << 28;

/// Longest plan of many jobs, in bytes: a few million files.
pub const PLAN_LEN_MAX: u64 = 1 << 30;

/// Longest report of a node, in bytes: a leaf that a million files reach into.
pub const REPORT_LEN_MAX: u64 = 1 << 26;

/// Expanded bytes of gzip data that a program may hold, however small the data is. Lines take up to thirty
/// times as much memory.
pub const EXPANSION_FREE: u64 = 1 << 20;

/// Most expanded bytes for each byte of gzip data of which a program holds the records, beyond
/// [`EXPANSION_FREE`]. Structures expand 4 to 15 times, lattices of points 10 to 40 times; only records that
/// repeat come near the 1,032 times of the format.
pub const EXPANSION_MAX: u64 = 100;

/// Checks the length of a file. `subject` is what the message says of it.
///
/// # Errors
/// Malformed, if it has more than `most` bytes.
pub fn check_len(subject: &str, len: u64, most: u64) -> Result<()> {
    if len <= most {
        return Ok(());
    }
    Err(Error::malformed(format!("{subject} {len} bytes, the maximum is {most}")))
}

/// Longest line of a text input, in bytes.
pub const TEXT_LINE_MAX: usize = 1 << 16;

/// Most numbers in a line of a text twin of four dimensions: with ten digits each, they fit a line.
pub const TEXT_NUMBERS_MAX: usize = 1 << 12;

/// Longest line of a molecular structure, in bytes: mmCIF may hold a whole sequence in one.
pub const STRUCTURE_LINE_MAX: usize = 1 << 24;

/// Most operators of a biological assembly of a structure.
pub const ASSEMBLY_COPIES_MAX: usize = 1 << 14;

/// Most copies of subchains in a biological assembly: they take 40 MB. Virus capsids have some thousand.
pub const ASSEMBLY_CHAINS_MAX: usize = 1 << 20;

/// Most atoms of a biological assembly, in all models: 1.9 GB, and the names of chains.
pub const ASSEMBLY_ATOMS_MAX: usize = 1 << 25;

/// Atoms that a biological assembly may have in any case: 40 MB with their tetrahedra.
pub const ASSEMBLY_ATOMS_SMALL: usize = 1 << 17;

/// Most atoms of a biological assembly made from `atoms` atoms. It allows the 1,680 copies of ten thousand
/// atoms of a capsid, but not that a few atoms become millions.
pub const fn assembly_atoms_max(atoms: usize) -> usize {
    let copied = atoms.saturating_mul(atoms / 4);
    let most = if copied < ASSEMBLY_ATOMS_SMALL { ASSEMBLY_ATOMS_SMALL } else { copied };
    if most < ASSEMBLY_ATOMS_MAX { most } else { ASSEMBLY_ATOMS_MAX }
}

/// Least number of images of points in a periodic box that may be made: 600 MB with their tetrahedra.
pub const IMAGES_SMALL: usize = 1 << 21;

/// Most images of `points` points in a periodic box. Boxes that are as long as wide, with hundreds of points
/// or more, need fewer images than points; small ones a hundred for each.
pub const fn images_max(points: usize) -> usize {
    let most = points.saturating_mul(32);
    if most < IMAGES_SMALL {
        IMAGES_SMALL
    } else if most < 1 << 25 {
        most
    } else {
        1 << 25
    }
}

/// Longest header line of a text twin, in bytes: it may hold a CRS, escaped.
pub const TEXT_HEADER_LINE_MAX: usize = 1 << 23;

/// Deepest level of a quadtree; with it a location code has 2 * 31 + 1 = 63 bits.
pub const QUADTREE_DEPTH_MAX: u8 = 31;

/// Deepest level of an octree; with it a location code has 3 * 20 + 1 = 61 bits.
pub const OCTREE_DEPTH_MAX: u8 = 20;

/// Most points of four dimensions in an input: 2.7 GB with values.
pub const POINTS4_MAX: u64 = 1 << 26;

/// Memory that a diagram in four dimensions needs at least, in bytes per distinct point. Grids take 1,100
/// bytes, random points more.
pub const DIAGRAM4_POINT_BYTES: u64 = 700;

/// Most sites of a grid of four dimensions from which points are selected: a pass over them takes hours.
pub const SITES4_MAX: u64 = 1 << 40;

/// Longest header of an NRRD file, in bytes.
pub const NRRD_HEADER_MAX: u64 = 1 << 20;

/// Most data files of an NRRD file.
pub const NRRD_FILES_MAX: usize = 1 << 16;

/// Longest number in the text of a volume or of coordinates without lines, in bytes.
pub const NUMBER_LEN_MAX: usize = 128;

/// Longest well-known text of polygons, in bytes: its vertices take ten times as much.
pub const WKT_LEN_MAX: u64 = 1 << 25;

/// Most vertices of breaklines, of which each becomes a knot.
pub const BREAKLINE_VERTICES_MAX: usize = 1 << 20;

/// Most vertices of lines that become edges of a mesh: noding takes 2 GB for them.
pub const LINE_VERTICES_MAX: usize = 1 << 24;

/// Memory of a vertex of lines while they are read and noded, in bytes.
pub const LINE_VERTEX_BYTES: u64 = 120;

/// Checks a number of vertices of lines, of which memory has room for `most`.
///
/// # Errors
/// Malformed, if there are more than [`LINE_VERTICES_MAX`]; memory, if there are more than `most`.
pub fn check_line_vertices(count: usize, most: usize) -> Result<()> {
    if count > LINE_VERTICES_MAX {
        return Err(Error::malformed(format!("more than {LINE_VERTICES_MAX} vertices of lines")));
    }
    if count <= most {
        return Ok(());
    }
    let found = counted(count as u64, "vertex", "vertices");
    let message = format!("{found} of lines so far, and --memory has room for {most}");
    Err(Error::new(ErrorKind::Memory, format!("{message}: raise it, or give fewer lines at once")))
}

/// Most crossings of lines: each becomes a vertex, and ends four edges.
pub const LINE_CROSSINGS_MAX: usize = 1 << 23;

/// Most files in a list of files: their names take about 100 MB.
pub const LIST_FILES_MAX: usize = 1 << 20;

/// Longest value of a tag of a TIFF file that is read, in bytes: those that say where cells are have a
/// hundred numbers.
pub const TIFF_TAG_BYTES_MAX: usize = 1 << 20;

/// Longest header of an array of numpy, in bytes; numpy has the same limit.
pub const NPY_HEADER_MAX: u32 = 10_000;

/// Longest tag of an XML file, in bytes.
pub const XML_TAG_MAX: usize = 1 << 16;

/// Deepest element of an XML file: VTK files have six levels.
pub const XML_DEPTH_MAX: usize = 64;

/// Longest block of a VTK file that is decompressed as a whole (LZ4), in bytes; VTK writes blocks of 32 KiB.
pub const VTK_BLOCK_MAX: u64 = 1 << 26;

/// Most tiles of a raster of triangles, of 65,536 cells each: their index takes 100 MB.
pub const RASTER_TILES_MAX: u64 = 1 << 22;

/// Most files of one raster.
pub const SHEETS_MAX: u64 = 1 << 20;

/// Most levels of contour lines that pass through one triangle: their open ends take about 40 MB.
pub const CONTOURS_PER_TRIANGLE_MAX: u64 = 1 << 17;

/// Most levels of contour lines that pass through a triangle on average, beyond those of one steep triangle.
/// Without this limit, the lines of a small file could take any memory.
pub const CONTOURS_PER_TRIANGLE_MEAN_MAX: u64 = 1 << 8;

/// Longest condition on points, in bytes.
pub const CONDITION_LEN_MAX: usize = 1 << 12;

/// Deepest parentheses of a condition.
pub const CONDITION_DEPTH_MAX: usize = 32;

/// Most vertices of a link that is not triangulated by circles: the search for its diagonals takes cubic
/// time.
pub const LINK_VERTICES_MAX: usize = 512;

/// Most entries of the hierarchy of a COPC file: 200 MB. A file of 10^11 points has fewer.
pub const COPC_ENTRIES_MAX: u64 = 1 << 22;

/// Most bytes of comments of SPA that are kept.
pub const SPA_COMMENTS_MAX: usize = 1 << 20;

/// Longest list of a row of PLY: useful polygons are shorter.
pub const PLY_LIST_MAX: u64 = 1 << 16;

/// Longest list of triangle strips of PLY, which often is the only one of a file. It takes 32 bytes for each.
pub const PLY_STRIPS_MAX: u64 = 1 << 24;

/// Most elements and properties of a header of PLY: far above any real header, and little memory.
pub const PLY_ITEMS_MAX: usize = 1000;

/// Deepest brackets of a coordinate reference system; definitions of the EPSG dataset have seven levels.
pub const CRS_DEPTH_MAX: usize = 32;

/// Deepest collection in a collection of a GeoPackage.
pub const WKB_DEPTH_MAX: u32 = 32;

/// Longest file of radii, in bytes.
pub const RADII_LEN_MAX: u64 = 1 << 24;

/// Longest value that SQLite may make of a GeoPackage of so many bytes: a little more than the file.
/// A file may be sparse, so there is a limit for all: as much as the most vertices take, each as a point.
pub fn geopackage_value_max(len: u64) -> i32 {
    len.saturating_add(1 << 16).min(1 << 30) as i32
}

/// Most steps of SQLite for a GeoPackage of so many bytes. A row with a geometry takes three to seven steps,
/// and at least 35 bytes; rows beyond [`LINE_VERTICES_MAX`] have too many vertices, whatever the length is.
pub fn geopackage_steps_max(len: u64) -> u64 {
    len.saturating_add(1_000_000).min(8 * LINE_VERTICES_MAX as u64)
}

/// Longest index of LAStools, in bytes: it takes five times as much while it is checked.
pub const LAX_LEN_MAX: u64 = 1 << 25;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_two_sides() {
        assert!(check_line_vertices(LINE_VERTICES_MAX, usize::MAX).is_ok());
        let message = check_line_vertices(LINE_VERTICES_MAX + 1, usize::MAX).unwrap_err().to_string();
        assert_eq!(message, "more than 16777216 vertices of lines");
        assert!(check_line_vertices(7, 7).is_ok());
        assert_eq!(check_line_vertices(8, 7).unwrap_err().kind(), ErrorKind::Memory);
    }

    #[test]
    fn sparse_files_bound_nothing() {
        assert_eq!(geopackage_value_max(0), 1 << 16);
        assert_eq!(geopackage_value_max(u64::MAX), 1 << 30);
        assert_eq!(geopackage_steps_max(1000), 1_001_000);
        // A second or two.
        assert_eq!(geopackage_steps_max(u64::MAX), 1 << 27);
    }

    #[test]
    fn assemblies_follow_their_files() {
        assert_eq!(assembly_atoms_max(0), ASSEMBLY_ATOMS_SMALL);
        assert_eq!(assembly_atoms_max(723), ASSEMBLY_ATOMS_SMALL);
        assert_eq!(assembly_atoms_max(728), 728 * 182);
        // A capsid of 1,680 copies of three chains.
        assert!(assembly_atoms_max(9_690) > 1_680 * 9_690);
        assert_eq!(assembly_atoms_max(usize::MAX), ASSEMBLY_ATOMS_MAX);
    }
}
