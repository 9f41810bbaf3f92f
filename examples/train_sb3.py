"""Train an agent with Stable-Baselines3 on one environment: `python examples/train_sb3.py --steps 20000`.

It needs the extra "rl": .venv/bin/pip install -c constraints.txt -e '.[rl]'. The agent acts at 100 Hz (`decimation`),
and sees and acts on scaled numbers, see `fo_gym.wrappers.AgentView`.
"""

import argparse

import gymnasium as gym
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor

from fo_gym.evaluation.runs.seeds import TRAINING_SEEDS, VALIDATION_SEEDS
from fo_gym.wrappers import AgentView


def make_env(seed: int) -> gym.Env:
    """The stiction task as agents like it, seeded."""
    env = Monitor(AgentView(gym.make("FJRStiction-v0", variant="randomized", decimation=10, duration=5.0)))
    env.reset(seed=seed)
    return env


def main() -> None:
    """Train, and show the mean return of a few episodes before and after."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=20_000, help="environment steps to train for")
    parser.add_argument("--seed", type=int, default=TRAINING_SEEDS[0], help="a training seed")
    arguments = parser.parse_args()
    env = make_env(arguments.seed)
    model = PPO("MlpPolicy", env, seed=arguments.seed, n_steps=500, batch_size=100)
    before, _ = evaluate_policy(model, make_env(VALIDATION_SEEDS[0]), n_eval_episodes=3)
    model.learn(arguments.steps)
    after, _ = evaluate_policy(model, make_env(VALIDATION_SEEDS[0]), n_eval_episodes=3)
    print(f"mean return of an episode: {before:.1f} before, {after:.1f} after {arguments.steps} steps")


if __name__ == "__main__":
    main()
