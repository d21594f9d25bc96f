// Stochastic pruning of clutter: how much longer a placement is drawn, 0 where it is gone. Twin: prune::scale.
// uses: frame

fn pruned_scale(instance: Instance) -> f32 {
    let distance = length(vec3f(instance.row_x.w, instance.row_y.w, instance.row_z.w) - frame.eye);
    let kept = frame.prune_start / max(distance, frame.prune_start);
    return select(scale_of_rank(instance.rank, kept), 1.0, instance.rank < 0.0);
}

fn scale_of_rank(rank: f32, kept: f32) -> f32 {
    let window = min(0.2 * (1.0 - kept), kept);
    let fade = clamp((kept - rank) / max(window, 1e-6), 0.0, 1.0);
    return sqrt(fade / max(kept - 0.5 * window, 1e-6));
}
