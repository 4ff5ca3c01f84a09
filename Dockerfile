# Plans the example part, or yours:
#
#   docker build -t viewgauge .
#   mkdir -p plan
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD/plan:/work/plan" viewgauge
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" viewgauge plan inspection.yaml -o plan
FROM python:3.11-slim

# The CAD kernel links the OpenGL library, though it draws nothing.
RUN apt-get update -q \
    && apt-get install -y -q --no-install-recommends libgl1 \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /opt/viewgauge
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY src src
RUN pip install --no-cache-dir --disable-pip-version-check --root-user-action=ignore -c constraints.txt ".[step]"
COPY examples/slotted_block examples/slotted_block

# Whoever runs the container keeps compiled kernels here and writes plans to /work.
RUN useradd --create-home planner \
    && mkdir -p /work/plan /var/cache/viewgauge \
    && chown -R planner:planner /work \
    && chmod 1777 /var/cache/viewgauge
ENV NUMBA_CACHE_DIR=/var/cache/viewgauge
USER planner
WORKDIR /work
ENTRYPOINT ["viewgauge"]
CMD ["plan", "/opt/viewgauge/examples/slotted_block/inspection.yaml", "-o", "/work/plan"]
