//! Tests of the first lines, for formats of molecules that are named in messages only.

/// The first lines.
fn lines(head: &[u8]) -> impl Iterator<Item = &str> {
    const SEEN: usize = 1000;
    head.split(|&byte| byte == b'\n').take(SEEN).map_while(|line| std::str::from_utf8(line).ok())
}

/// Whether the text is a data file of LAMMPS, which states the limits of its box, or a dump.
pub(crate) fn is_lammps(head: &[u8]) -> bool {
    let is_limits = |line: &str| line.split_ascii_whitespace().skip(2).take(2).eq(["xlo", "xhi"]);
    head.starts_with(b"ITEM: TIMESTEP") || lines(head).any(is_limits)
}

/// Whether the text is a MOL2 file.
pub(crate) fn is_mol2(head: &[u8]) -> bool {
    lines(head).any(|line| line.starts_with("@<TRIPOS>"))
}

/// Whether the text is an SDF or MOL file: its fourth line ends with a version.
pub(crate) fn is_sdf(head: &[u8]) -> bool {
    lines(head)
        .nth(3)
        .is_some_and(|line| [" V2000", " V3000"].iter().any(|end| line.trim_end().ends_with(end)))
}
