# visviva with pictures and the viewer: docker build -t visviva . && docker run --rm -v "$PWD:/work" visviva run crane
FROM python:3.12-slim-bookworm AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ && rm -rf /var/lib/apt/lists/*
COPY . /source
RUN pip wheel --no-deps -w /wheels /source

FROM python:3.12-slim-bookworm
RUN apt-get update && apt-get install -y --no-install-recommends libgomp1 libegl1 libegl-mesa0 libgl1-mesa-dri libxrender1 \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir "$(echo /wheels/*.whl)[view]" && rm -rf /wheels && useradd --create-home user
USER user
WORKDIR /work
ENTRYPOINT ["visviva"]
CMD ["--help"]
