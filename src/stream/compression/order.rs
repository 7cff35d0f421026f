//! Sorts a column by what is known of its records, so that numbers of one magnitude stand together.

/// Shortest run of one key that the encoder gives a segment of its own.
const SEGMENT: usize = 1024;
/// Keys are sums of the lengths of two numbers in bits.
const KEYS: usize = 65;

/// The records in the order of their keys; those with equal keys in their own order.
pub(super) fn by_keys(keys: &[u8]) -> Vec<u32> {
    let ends = ends(keys);
    let mut places = [0; KEYS];
    places[1..].copy_from_slice(&ends[..KEYS - 1]);
    let mut order = vec![0; keys.len()];
    for (record, &key) in (0..).zip(keys) {
        let place = &mut places[usize::from(key)];
        order[*place as usize] = record;
        *place += 1;
    }
    order
}

/// Places in the order of keys at which a segment ends.
pub(super) fn segment_ends(keys: &[u8]) -> Vec<usize> {
    let (mut segments, mut last) = (Vec::new(), 0);
    for end in ends(keys).map(|end| end as usize) {
        if end - last >= SEGMENT && keys.len() - end >= SEGMENT / 2 {
            segments.push(end);
            last = end;
        }
    }
    segments
}

/// For each key, the number of records with that key or a lower one.
fn ends(keys: &[u8]) -> [u32; KEYS] {
    let mut ends = [0; KEYS];
    keys.iter().for_each(|&key| ends[usize::from(key)] += 1);
    for key in 1..KEYS {
        ends[key] += ends[key - 1];
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_stable() {
        assert_eq!(by_keys(&[5, 0, 64, 5, 0]), [1, 4, 0, 3, 2]);
        assert_eq!(by_keys(&[]), []);
    }

    #[test]
    fn segments_are_long() {
        let keys: Vec<u8> = (0..5000).map(|i| (i / 500) as u8).collect();
        assert_eq!(segment_ends(&keys), [1500, 3000]);
    }
}
