"""Gymnasium environments: single and vector entry points over one batched simulation."""
