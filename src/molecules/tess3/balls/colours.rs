//! Colours of elements, and of things that are counted.

/// Red, green and blue.
pub(super) type Colour = [u8; 3];

/// What has no colour of its own.
pub(super) const GREY: Colour = [200, 200, 205];

/// Colours that differ clearly, next to each other in pairs of chains and of pockets.
const DISTINCT: [Colour; 10] = [
    [86, 156, 214],
    [230, 140, 40],
    [60, 160, 120],
    [204, 105, 165],
    [120, 110, 200],
    [190, 80, 60],
    [150, 190, 80],
    [80, 185, 200],
    [220, 180, 90],
    [150, 120, 100],
];

/// The colour of the element with an atomic number, after Corey, Pauling and Koltun (CPK).
pub(super) fn of_element(number: u8) -> Colour {
    match number {
        1 => [240, 240, 240],
        6 => [190, 190, 192],
        7 => [90, 115, 225],
        8 => [225, 80, 70],
        9 | 17 => [90, 200, 90],
        15 => [235, 150, 60],
        16 => [230, 200, 80],
        26 => [205, 105, 60],
        35 | 53 => [150, 70, 60],
        0 => GREY,
        _ => [160, 130, 190],
    }
}

/// A colour for a number from 1 on; grey for 0.
pub(super) fn of_number(number: u32) -> Colour {
    number.checked_sub(1).map_or(GREY, |index| DISTINCT[index as usize % DISTINCT.len()])
}
