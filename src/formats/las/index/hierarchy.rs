//! The nodes of a COPC file, from the pages of its hierarchy.
//!
//! Source: COPC specification 1.0, copc.io. All pages are read: only then is it known that each chunk belongs
//! to a node. They take 32 bytes per node, as a rule less than a thousandth of its points.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::las::index::wrong_index;
use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::COPC_ENTRIES_MAX;

const ENTRY_LEN: u64 = 32;

/// The number of points of an entry that stands for a page.
const IS_PAGE: i32 = -1;

/// Deepest level: positions of its nodes fit 31 bits.
const LEVEL_MAX: u32 = 31;

/// Which cube of the octree a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    /// 0 for the root.
    pub(crate) level: u32,
    /// Number of the cube along each axis, below 2^level.
    pub(crate) position: [u32; 3],
}

impl Key {
    fn parent(self) -> Option<Key> {
        Some(Key { level: self.level.checked_sub(1)?, position: self.position.map(|number| number / 2) })
    }

    /// The key, for messages.
    pub(crate) fn describe(self) -> String {
        let Key { level, position: [x, y, z] } = self;
        format!("node {level}-{x}-{y}-{z}")
    }
}

/// Points that are one chunk of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) key: Key,
    /// First byte, and length in bytes.
    pub(crate) start: u64,
    pub(crate) len: u64,
    /// 0 for a node that only has children.
    pub(crate) points: u64,
}

enum Entry {
    Node(Node),
    Page(Range<u64>),
}

/// Reads the nodes of the page at the bytes `root`, and of all pages below it. They are sorted by their keys.
///
/// # Errors
/// If a page is not in the file, is listed twice, there are more than [`COPC_ENTRIES_MAX`] entries, or the keys
/// of the nodes are those of no tree.
pub(crate) fn read_nodes(file: &FileView, root: Range<u64>) -> Result<Vec<Node>> {
    let (mut nodes, mut pages, mut seen) = (Vec::new(), vec![root], BTreeSet::new());
    let mut entries = 0;
    while let Some(page) = pages.pop() {
        let at = |error: Error| error.at(format!("page of the hierarchy at byte {}", page.start));
        if !seen.insert(page.start) {
            return Err(at(wrong_index("the page is listed twice")));
        }
        entries += check_page(&page, file.len()).map_err(at)?;
        check_entries(entries, file.len()).map_err(at)?;
        let mut bytes = vec![0; (page.end - page.start) as usize];
        file.read_at(page.start, &mut bytes).map_err(|e| at(Error::io("reading", e)))?;
        for entry in bytes.as_chunks().0 {
            match read_entry(entry).map_err(at)? {
                Entry::Node(node) => nodes.push(node),
                Entry::Page(page) => pages.push(page),
            }
        }
    }
    nodes.sort_unstable_by_key(|node| node.key);
    check_tree(&nodes)?;
    Ok(nodes)
}

/// Checks the number of entries that the pages so far have.
fn check_entries(entries: u64, file_len: u64) -> Result<()> {
    if entries <= COPC_ENTRIES_MAX.min(file_len / ENTRY_LEN) {
        return Ok(());
    }
    Err(wrong_index(format!("{entries} entries or more, too many for the file")))
}

/// The number of entries of a page.
fn check_page(page: &Range<u64>, file_len: u64) -> Result<u64> {
    let len = page.end.saturating_sub(page.start);
    if len == 0 || !len.is_multiple_of(ENTRY_LEN) {
        return Err(wrong_index(format!("a page of {len} bytes, expected entries of {ENTRY_LEN}")));
    }
    if page.end > file_len {
        return Err(wrong_index(format!("the page ends at byte {}, the file at byte {file_len}", page.end)));
    }
    Ok(len / ENTRY_LEN)
}

fn read_entry(bytes: &[u8; ENTRY_LEN as usize]) -> Result<Entry> {
    let (numbers, _) = bytes.as_chunks::<4>();
    let number = |index: usize| i32::from_le_bytes(numbers[index]);
    let start = u64::from(number(4) as u32) | u64::from(number(5) as u32) << 32;
    let (len, points) = (number(6), number(7));
    let stated = [number(0), number(1), number(2), number(3)];
    let wrong = || {
        let [level, x, y, z] = stated;
        wrong_index(format!("node {level}-{x}-{y}-{z} with {points} points in {len} bytes at byte {start}"))
    };
    if points == IS_PAGE {
        let len = u64::try_from(len).map_err(|_| wrong())?;
        return Ok(Entry::Page(start..start.checked_add(len).ok_or_else(wrong)?));
    }
    let points = u64::try_from(points).map_err(|_| wrong())?;
    // The other numbers of a node without points mean nothing.
    let len = if points == 0 { 0 } else { u64::try_from(len).map_err(|_| wrong())? };
    let key = read_key(stated).ok_or_else(wrong)?;
    Ok(Entry::Node(Node { key, start, len, points }))
}

fn read_key([level, x, y, z]: [i32; 4]) -> Option<Key> {
    let level = u32::try_from(level).ok().filter(|&level| level <= LEVEL_MAX)?;
    let number = |number: i32| u32::try_from(number).ok().filter(|&number| u64::from(number) < 1 << level);
    Some(Key { level, position: [number(x)?, number(y)?, number(z)?] })
}

/// Checks that no key is there twice, and that each one below the root has its parent.
fn check_tree(nodes: &[Node]) -> Result<()> {
    if let Some(pair) = nodes.windows(2).find(|pair| pair[0].key == pair[1].key) {
        return Err(wrong_index(format!("{} is there twice", pair[0].key.describe())));
    }
    let is_there = |key: Key| nodes.binary_search_by_key(&key, |node| node.key).is_ok();
    match nodes.iter().find(|node| node.key.parent().is_some_and(|parent| !is_there(parent))) {
        Some(orphan) => Err(wrong_index(format!("the parent of {} is missing", orphan.key.describe()))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::origin::Origin;

    fn entry(key: [i32; 4], start: u64, len: i32, points: i32) -> Vec<u8> {
        let mut bytes: Vec<u8> = key.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(start.to_le_bytes());
        bytes.extend([len, points].iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    /// Reads a file of these entries, of which the first ones are the page of the root.
    fn read(root: usize, entries: &[Vec<u8>]) -> Result<Vec<Node>> {
        let origin = Origin::spooled(&entries.concat()[..], &std::env::temp_dir()).expect("spooled");
        read_nodes(&origin.view().expect("a view"), 0..ENTRY_LEN * root as u64)
    }

    fn assert_wrong(root: usize, entries: &[Vec<u8>], what: &str) {
        let message = read(root, entries).expect_err(what).to_string();
        assert!(message.contains(what) && message.contains("without the index"), "{what}: {message}");
    }

    #[test]
    fn pages_are_read_below_pages() {
        let root = [entry([0; 4], 500, 9, 3), entry([1, 0, 1, 1], 64, 64, IS_PAGE)];
        let below = [entry([1, 0, 1, 1], -1i64 as u64, -7, 0), entry([2, 0, 3, 2], 900, 5, 1)];
        let nodes = read(2, &[&root[..], &below[..]].concat()).unwrap();
        let found: Vec<_> = nodes.iter().map(|node| (node.key.describe(), node.points)).collect();
        let expected = [("node 0-0-0-0", 3), ("node 1-0-1-1", 0), ("node 2-0-3-2", 1)];
        assert_eq!(found, expected.map(|(name, points)| (name.to_string(), points)));
        assert_eq!((nodes[2].start, nodes[2].len), (900, 5));
    }

    #[test]
    fn pages_that_lead_nowhere_are_errors() {
        let node = || entry([0; 4], 500, 9, 3);
        let page = |start, len| entry([1, 0, 0, 0], start, len, IS_PAGE);
        assert_wrong(2, &[node(), page(0, 64)], "listed twice");
        assert_wrong(2, &[node(), page(64, 32), page(64, 32), node(), node()], "listed twice");
        assert_wrong(2, &[node(), page(32, 32), node(), node()], "listed twice");
        // Pages that overlap.
        let shifted = [node(), page(64, 64), page(96, 32), node()];
        assert_wrong(2, &shifted, "too many for the file");
        assert_wrong(2, &[node(), page(64, 32)], "the page ends at byte 96, the file at byte 64");
        assert_wrong(2, &[node(), page(u64::MAX, 32)], "in 32 bytes at byte 18446744073709551615");
        assert_wrong(2, &[node(), page(32, 31)], "a page of 31 bytes");
        assert_wrong(2, &[node(), page(32, 0)], "a page of 0 bytes");
        assert_wrong(2, &[node(), page(32, -32)], "in -32 bytes");
        assert_wrong(0, &[node()], "a page of 0 bytes");
    }

    #[test]
    fn entries_have_a_limit() {
        let enough = (COPC_ENTRIES_MAX + 1) * ENTRY_LEN;
        assert!(check_entries(COPC_ENTRIES_MAX, enough).is_ok());
        let message = check_entries(COPC_ENTRIES_MAX + 1, enough).unwrap_err().to_string();
        assert!(message.contains("4194305 entries or more, too many"), "{message}");
        assert!(check_entries(3, 3 * ENTRY_LEN).is_ok() && check_entries(3, 3 * ENTRY_LEN - 1).is_err());
    }

    #[test]
    fn keys_of_no_tree_are_errors() {
        let node = |key| entry(key, 500, 9, 3);
        assert_wrong(1, &[node([0, 1, 0, 0])], "node 0-1-0-0");
        assert_wrong(1, &[node([-1, 0, 0, 0])], "node -1-0-0-0");
        assert_wrong(1, &[node([32, 0, 0, 0])], "node 32-0-0-0");
        assert_wrong(2, &[node([0; 4]), node([1, 0, 0, 2])], "node 1-0-0-2");
        assert_wrong(2, &[node([0; 4]), node([1, 0, -1, 0])], "node 1-0--1-0");
        assert_wrong(2, &[node([0; 4]), node([0; 4])], "node 0-0-0-0 is there twice");
        assert_wrong(2, &[node([0; 4]), node([2, 0, 0, 0])], "the parent of node 2-0-0-0");
        assert_wrong(1, &[entry([0; 4], 500, 9, -2)], "-2 points");
        assert_wrong(1, &[entry([0; 4], 500, -9, 2)], "in -9 bytes");
    }
}
