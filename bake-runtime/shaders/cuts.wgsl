// Places that divide a ray, in order.
// uses: sight

struct Cuts {
    at: array<Place, CUTS>,
    count: u32,
}

// Keeps the list in order; what does not lie between `begin` and `end` is no cut.
fn add_cut(cuts: ptr<function, Cuts>, at: Place, begin: Place, end: Place) {
    if !(lies_before(begin, at) && lies_before(at, end)) || (*cuts).count >= CUTS {
        return;
    }
    var i = (*cuts).count;
    while i > 0u && lies_before(at, (*cuts).at[i - 1u]) {
        (*cuts).at[i] = (*cuts).at[i - 1u];
        i--;
    }
    (*cuts).at[i] = at;
    (*cuts).count++;
}
