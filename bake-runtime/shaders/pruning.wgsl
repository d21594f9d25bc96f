// Stochastic pruning of clutter: how much longer a placement is drawn, 0 where it is gone. Twin: prune::scale.
// uses: frame

fn pruned_scale(instance: Instance) -> f32 {
    let distance = length(vec3f(instance.row_x.w, instance.row_y.w, instance.row_z.w) - frame.eye);
    let kept = frame.prune_start / max(distance, frame.prune_start);
    let window = min(0.2 * (1.0 - kept), kept);
    let fade = clamp((kept - instance.rank) / max(window, 1e-6), 0.0, 1.0);
    return select(sqrt(fade / max(kept - 0.5 * window, 1e-6)), 1.0, instance.rank < 0.0);
}
