# Glint with every tool that its checks use.
#
#   docker build -t glint .
#   docker run --rm -v "$PWD:/work" -w /work glint generate configs/rough.toml --out build
FROM rust:1-bookworm

WORKDIR /opt/glint
COPY . .
RUN bash tools/install && cargo install --locked --path . && cargo clean
ENV PATH="/opt/glint/target/tools/venv/bin:${PATH}"
ENTRYPOINT ["glint"]
