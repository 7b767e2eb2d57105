"""An agent that touches at random for a few seconds: the shortest example of an environment.

python examples/random_agent.py hand_sandbox/BoxToGoal-v1
"""

import sys

import gymnasium

id = sys.argv[1] if len(sys.argv) > 1 else "hand_sandbox/BoxToGoal-v1"
# The part before the colon is imported, and registers the ids.
env = gymnasium.make(f"sandbox.gym:{id}")
env.action_space.seed(7)
observation, info = env.reset(seed=7)
print(f"trial {info['seed']}: {', '.join(f'{k} {v.shape}' for k, v in observation.items())}")
total, steps, over = 0.0, 0, False
while not over and steps < 250:
    if steps % 25 == 0:
        action = env.action_space.sample()
    observation, reward, terminated, truncated, info = env.step(action)
    total, steps, over = total + reward, steps + 1, terminated or truncated
print(f"{steps} steps, {observation['time'][0]:.2f} s, reward {total:.3f}, {info['state_hash']}")
env.close()
