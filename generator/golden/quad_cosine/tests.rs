use super::*;

#[test]
fn roots_are_nearest() {
    // √2 = 1.41421, √(7/16) = 0.66144, √(1000/16) = 7.90569, √(1023/16) = 7.99609.
    assert_eq!(root(0, 16, 14), 0);
    assert_eq!(root(1, 1, 14), 16384);
    assert_eq!(root(2, 2, 14), 16384);
    assert_eq!(root(7, 16, 14), 10837);
    assert_eq!(root(1000, 16, 14), 129527);
    assert_eq!(root(1023, 16, 14), 131008);
    assert_eq!(root(3, 4, 4), 14);
}

#[test]
fn the_decoder_at_its_edges() {
    let ranges = [0, 1, 2, 3, 6, 7, 1000, 1023].map(|n| POWERS[range_of(n)]);
    assert_eq!(ranges, [16, 1, 2, 4, 4, 16, 16, 16]);
}
