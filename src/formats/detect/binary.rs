//! Tests of the first bytes, for formats without fixed magic bytes.

/// Whether the root element is that of VTK.
pub(crate) fn is_vtk_xml(head: &[u8]) -> bool {
    const ROOT: &[u8] = b"<VTKFile";
    let text = head.trim_ascii_start();
    text.starts_with(ROOT)
        || (text.starts_with(b"<?xml") || text.starts_with(b"<!--"))
            && text.windows(ROOT.len()).any(|window| window == ROOT)
}

/// Whether `head` is a NIfTI-1 or NIfTI-2 header, which starts with its own length in either byte order.
pub(crate) fn is_nifti(head: &[u8]) -> bool {
    const MAGIC_AT: usize = 344;
    let states = |len: u32| head.starts_with(&len.to_le_bytes()) || head.starts_with(&len.to_be_bytes());
    let has_magic = head.get(MAGIC_AT..MAGIC_AT + 2).is_some_and(|magic| magic == b"n+" || magic == b"ni");
    states(348) && has_magic || states(540) && head.get(4..6) == Some(b"n+")
}

/// Whether `head` is BinaryCIF: a map of MessagePack that starts with one of the keys of such files.
pub(crate) fn is_binary_cif(head: &[u8]) -> bool {
    // A map of up to 15 entries, and a text of 7 or 10 bytes.
    let is_map = matches!(head.first(), Some(0x80..=0x8f));
    let keys: [&[u8]; 3] = [b"\xa7encoder", b"\xa7version", b"\xaadataBlocks"];
    is_map && keys.iter().any(|key| head[1..].starts_with(key))
}

/// Whether `head` is MMTF: a map of MessagePack with the key of its version near the start.
pub(crate) fn is_mmtf(head: &[u8]) -> bool {
    const KEY: &[u8] = b"mmtfVersion";
    matches!(head.first(), Some(0x80..=0x8f | 0xde | 0xdf))
        && head.windows(KEY.len()).any(|window| window == KEY)
}

/// Whether `head` is an SPB header: version 7, byte order 0 or 1, then data type (two bits) and finalization
/// method.
pub(crate) fn is_spb(head: &[u8]) -> bool {
    matches!(*head, [7, 0 | 1, flags, ..] if flags & 3 < 3 && flags >> 2 <= 4)
}

/// Whether `head` is an SMB header: version 0, byte order 0 or 1, no compression. All-zero bytes do not
/// count.
pub(crate) fn is_smb(head: &[u8]) -> bool {
    matches!(head, [0, 0 | 1, 0, 0, ..]) && head.iter().any(|&byte| byte != 0)
}

/// Whether `head` is an STL surface as text. Those of bytes have no mark.
pub(crate) fn is_stl(head: &[u8]) -> bool {
    const FACET: &[u8] = b"facet normal";
    head.starts_with(b"solid") && head.windows(FACET.len()).any(|window| window == FACET)
}

/// Whether `head` starts as DXF does: the number 0, and a section on a line of its own.
pub(crate) fn is_dxf(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    head.starts_with(b"AutoCAD Binary DXF") || lines.next() == Some(b"0") && lines.next() == Some(b"SECTION")
}

/// Whether `head` is a PTX scan: numbers of columns and rows, then the place and the axes of the scanner in
/// lines of three numbers, and a matrix of four by four.
pub(crate) fn is_ptx(head: &[u8]) -> bool {
    let counts = head
        .split(|&byte| byte == b'\n')
        .take(10)
        .map(|line| line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count());
    counts.eq([1, 1, 3, 3, 3, 3, 4, 4, 4, 4])
}

/// Whether `head` is JSON: an object that starts with a name.
pub(crate) fn is_json(head: &[u8]) -> bool {
    let text = head.trim_ascii_start();
    text.strip_prefix(b"{").is_some_and(|rest| rest.trim_ascii_start().starts_with(b"\""))
}

/// Whether `head` is an ASCII grid: its first two lines state numbers of columns and rows.
pub(crate) fn is_ascii_grid(head: &[u8]) -> bool {
    let starts = |line: Option<&[u8]>, name: &[u8]| {
        line.and_then(|line| line.trim_ascii_start().get(..name.len()))
            .is_some_and(|word| word.eq_ignore_ascii_case(name))
    };
    let mut lines = head.split(|&byte| byte == b'\n');
    starts(lines.next(), b"ncols") && starts(lines.next(), b"nrows")
}

/// Whether `head` is DICOM, behind a preamble of 128 bytes.
pub(crate) fn is_dicom(head: &[u8]) -> bool {
    head.get(128..132) == Some(b"DICM")
}
