!> Unit test of assembly: patch test, rigid motions, tangent against differences, removed and inverted elements, order of elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_assembly
  use amontons_assembly_plan, only: assembly_type, create_assembly, add_node_block
  use amontons_assembly, only: assemble_forces, assemble_tangent, element_material
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_sparse, only: multiply_symmetric
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use amontons_element_kinds, only: KIND_C3D8, KIND_C3D8I
  use check, only: suite_type
  implicit none
  real(DP), parameter :: E = 200.0_DP, NU = 0.3_DP
  type(suite_type) :: suite
  call check_patch(KIND_C3D8, 3)
  call check_patch(KIND_C3D8I, 2)
  call check_rigid()
  call check_tangent()
  call check_removed()
  call check_born()
  call check_inverted()
  call check_order()
  call check_blocks()
  call suite%finish()

contains

  !> A block of n x n x n hexahedra on [0, n]^3 whose inner nodes are shaken; one isotropic material.
  subroutine make_block(kind, n, model, state, assembly)
    integer, intent(in) :: kind, n
    type(model_type), intent(out) :: model
    type(state_type), intent(out) :: state
    type(assembly_type), intent(out) :: assembly
    type(error_type), allocatable :: error
    type(slave_state_type) :: no_slaves(0)
    integer :: i, j, k, m, row
    row = n + 1
    associate (mesh => model%mesh)
      mesh%n_nodes = row**3
      mesh%n_elements = n**3
      allocate (mesh%coordinates(3, mesh%n_nodes), mesh%nodes(0), mesh%node_sets(0), mesh%element_sets(0))
      do k = 0, n
        do j = 0, n
          do i = 0, n
            m = 1 + i + row * (j + row * k)
            mesh%coordinates(:, m) = real([i, j, k], DP)
            if (all([i, j, k] > 0 .and. [i, j, k] < n)) mesh%coordinates(:, m) = mesh%coordinates(:, m) + 0.15_DP * &
              sin(real(m, DP) * [1.0_DP, 2.0_DP, 3.0_DP])
          end do
        end do
      end do
      do k = 0, n - 1
        do j = 0, n - 1
          do i = 0, n - 1
            m = 1 + i + row * (j + row * k)
            mesh%nodes = [mesh%nodes, m, m + 1, m + 1 + row, m + row]
            mesh%nodes = [mesh%nodes, mesh%nodes(size(mesh%nodes) - 3:) + row**2]
          end do
        end do
      end do
      mesh%kind = spread(kind, 1, mesh%n_elements)
      mesh%material = spread(1, 1, mesh%n_elements)
      mesh%first = [(8 * i - 7, i=1, mesh%n_elements + 1)]
      mesh%node_label = [(i, i=1, mesh%n_nodes)]
      mesh%element_label = [(i, i=1, mesh%n_elements)]
      call finalize_mesh(mesh)
    end associate
    allocate (model%materials(1), model%steps(1), model%amplitudes(0))
    model%materials(1)%youngs_modulus = E
    model%materials(1)%poissons_ratio = NU
    model%materials(1)%has_elastic = .true.
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
    call create_assembly(assembly, model%mesh, error)
    call suite%that('created', .not. allocated(error))
  end subroutine make_block


  !> u = G x: the stress of the law everywhere, no force on inner nodes, the traction times the area on a face.
  subroutine check_patch(kind, n)
    integer, intent(in) :: kind, n
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    real(DP), parameter :: G(3, 3) = 1.0e-3_DP * reshape([1.0_DP, 2.0_DP, 0.5_DP, -1.0_DP, 3.0_DP, 1.0_DP, 2.0_DP, 0.0_DP, &
      -2.0_DP], &
      [3, 3])
    real(DP) :: strain(3, 3), stress(3, 3), force(3)
    integer :: failed, i
    call make_block(kind, n, model, state, assembly)
    state%new%u = matmul(G, model%mesh%coordinates)
    call assemble_forces(assembly, model, .false., state, failed)
    strain = 0.5_DP * (G + transpose(G))
    stress = E / (1 + NU) * strain
    do i = 1, 3
      stress(i, i) = stress(i, i) + E * NU / ((1 + NU) * (1 - 2 * NU)) * (strain(1, 1) + strain(2, 2) + strain(3, 3))
    end do
    call suite%that('patch: no failure', failed == 0)
    call suite%near('patch: stress', maxval(abs(state%new%stress - spread([stress(1, 1), stress(2, 2), stress(3, 3), stress(1, 2), &
      stress(2, 3), stress(1, 3)], 2, model%mesh%n_points))), 0.0_DP, 1.0e-13_DP)
    force = 0
    do i = 1, model%mesh%n_nodes
      associate (x => model%mesh%coordinates(:, i), f => state%new%internal_force(:, i))
        if (all(x > 0.5_DP .and. x < real(n, DP) - 0.5_DP)) call suite%near('patch: no force inside', maxval(abs(f)), 0.0_DP, &
          1.0e-13_DP)
        if (all(x(2:) > 0.5_DP .and. x(2:) < real(n, DP) - 0.5_DP) .and. x(1) > real(n, DP) - 0.5_DP) force = force + f
      end associate
    end do
    call suite%near('patch: force on the face x = n without its rim', maxval(abs(force - real((n - 1)**2, DP) * stress(:, 1))), &
      0.0_DP, 1.0e-12_DP)
    call suite%near('patch: energy', sum(state%new%energy * state%new%volume), 0.5_DP * sum(stress * strain) * real(n**3, DP), &
      1.0e-14_DP)
    call assemble_tangent(assembly, model, .false., state, failed)
    call suite%near('patch: K u = F', maxval(abs(product_of(assembly, state%new%u) - state%new%internal_force)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_patch


  !> K u as vectors at nodes.
  function product_of(assembly, u) result(force)
    type(assembly_type), intent(in) :: assembly
    real(DP), intent(in) :: u(:, :)
    real(DP) :: force(3, size(u, 2)), y(size(u))
    call multiply_symmetric(assembly%stiffness, reshape(u, [size(u)]), y)
    force = reshape(y, shape(force))
  end function product_of


  !> A large rotation under NLGEOM has no stress.
  subroutine check_rigid()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    real(DP), parameter :: R(3, 3) = reshape([0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    integer :: failed
    call make_block(KIND_C3D8, 2, model, state, assembly)
    state%new%u = matmul(R, model%mesh%coordinates) - model%mesh%coordinates + 5.0_DP
    call assemble_forces(assembly, model, .true., state, failed)
    call suite%near('rigid: stress', maxval(abs(state%new%stress)), 0.0_DP, 1.0e-11_DP)
    call suite%near('rigid: force', maxval(abs(state%new%internal_force)), 0.0_DP, 1.0e-11_DP)
    call assemble_forces(assembly, model, .false., state, failed)
    call suite%that('rigid: small strains see one', maxval(abs(state%new%stress)) > 1.0_DP)
  end subroutine check_rigid


  !> The tangent under NLGEOM against central differences; elements in batches and one by one.
  subroutine check_tangent()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    real(DP), parameter :: H = 1.0e-6_DP
    real(DP), allocatable :: u(:, :), du(:, :), plus(:, :), minus(:, :), work(:, :)
    integer :: failed, i, n
    do n = 1, 2                                      ! one element alone; eight in a batch
      call make_block(KIND_C3D8, n, model, state, assembly)
      u = 0.05_DP * reshape([(sin(real(i, DP)), i=1, 3 * model%mesh%n_nodes)], [3, model%mesh%n_nodes])
      du = reshape([(cos(real(3 * i, DP)), i=1, 3 * model%mesh%n_nodes)], [3, model%mesh%n_nodes])
      state%new%u = u + H * du
      call assemble_forces(assembly, model, .true., state, failed)
      plus = state%new%internal_force
      state%new%u = u - H * du
      call assemble_forces(assembly, model, .true., state, failed)
      minus = state%new%internal_force
      state%new%u = u
      call assemble_forces(assembly, model, .true., state, failed)
      call assemble_tangent(assembly, model, .true., state, failed)
      work = product_of(assembly, du)
      call suite%near('tangent', norm2(work - (plus - minus) / (2 * H)), 0.0_DP, 1.0e-7_DP * norm2(work))
    end do
  end subroutine check_tangent


  !> An element that was removed has no force, stress or stiffness; another material from a step on.
  subroutine check_removed()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    integer :: failed, i
    call make_block(KIND_C3D8, 2, model, state, assembly)
    state%new%step = 1
    allocate (model%steps(1)%is_inactive(8), source=.false.)
    model%steps(1)%is_inactive(8) = .true.
    state%new%u = 1.0e-3_DP * model%mesh%coordinates
    call assemble_forces(assembly, model, .false., state, failed)
    call suite%near('removed: corner 27 is free', maxval(abs(state%new%internal_force(:, 27))), 0.0_DP, 0.0_DP)
    call suite%near('removed: its stress', maxval(abs(state%new%stress(:, 57:))), 0.0_DP, 0.0_DP)
    call suite%that('removed: the others stay', minval(abs(state%new%stress(1, :56))) > 0.1_DP)
    call assemble_tangent(assembly, model, .false., state, failed)
    associate (K => assembly%stiffness)
      call suite%near('removed: no stiffness', maxval(abs(K%value(K%first(79):K%first(82) - 1))), 0.0_DP, 0.0_DP)
    end associate
    model%materials = [model%materials, model%materials]
    model%steps(1)%material = [2, (1, i=2, 8)]
    call suite%that('material of a step', element_material(model, 1, 1) == 2 .and. element_material(model, 1, 2) == 1)
    model%mesh%material(3) = 0
    deallocate (model%steps(1)%material)
    call suite%that('the first where there is none', element_material(model, 1, 3) == 1)
  end subroutine check_removed


  !> An element that came back has no stress at the displacement of its return.
  subroutine check_born()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    integer :: failed, i
    call make_block(KIND_C3D8, 2, model, state, assembly)
    state%new%u = 1.0e-2_DP * model%mesh%coordinates
    allocate (state%new%birth_displacement(3, size(model%mesh%nodes)), source=0.0_DP)
    do i = model%mesh%first(3), model%mesh%first(4) - 1
      state%new%birth_displacement(:, i) = state%new%u(:, model%mesh%nodes(i))
    end do
    call assemble_forces(assembly, model, .true., state, failed)
    call suite%near('born: no stress', maxval(abs(state%new%stress(:, 17:24))), 0.0_DP, 1.0e-12_DP)
    call suite%that('born: stress of its neighbour', maxval(abs(state%new%stress(:, 9:16))) > 1.0_DP)
  end subroutine check_born


  !> The first element that is turned inside out is reported.
  subroutine check_inverted()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    integer :: failed
    call make_block(KIND_C3D8, 2, model, state, assembly)
    state%new%u(:, 27) = -4.0_DP                     ! the far corner of element 8 beyond its opposite corner
    call assemble_forces(assembly, model, .true., state, failed)
    call suite%that('inverted: element 8', failed == 8)
    state%new%u(:, 1) = 4.0_DP
    call assemble_forces(assembly, model, .true., state, failed)
    call suite%that('inverted: the first of two', failed == 1)
  end subroutine check_inverted


  !> A thousand elements: each once, elements of a colour share no node, parts do not touch.
  subroutine check_order()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    integer, allocatable :: owner(:)
    integer :: g, i, k, e
    logical :: is_apart
    call make_block(KIND_C3D8, 10, model, state, assembly)
    call suite%that('order: four parts', assembly%n_parts == 4 .and. assembly%n_groups > 2)
    call suite%that('order: each once', all([(any(assembly%element_order == e), e=1, 1000)]) .and. &
      size(assembly%element_order) == 1000)
    allocate (owner(model%mesh%n_nodes))
    is_apart = .true.
    do g = assembly%n_parts + 1, assembly%n_groups
      owner = 0
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1
        e = assembly%element_order(i)
        do k = model%mesh%first(e), model%mesh%first(e + 1) - 1
          is_apart = is_apart .and. owner(model%mesh%nodes(k)) == 0
          owner(model%mesh%nodes(k)) = e
        end do
      end do
    end do
    call suite%that('order: no node twice in a colour', is_apart)
    owner = 0
    is_apart = .true.
    do g = 1, assembly%n_parts
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1
        e = assembly%element_order(i)
        do k = model%mesh%first(e), model%mesh%first(e + 1) - 1
          is_apart = is_apart .and. any(owner(model%mesh%nodes(k)) == [0, g])
          owner(model%mesh%nodes(k)) = g
        end do
      end do
    end do
    call suite%that('order: parts have no common node', is_apart)
  end subroutine check_order


  !> Couplings widen the pattern; blocks go to both their places.
  subroutine check_blocks()
    type(model_type) :: model
    type(state_type) :: state
    type(assembly_type) :: assembly
    type(error_type), allocatable :: error
    real(DP) :: u(3, 27), f(3, 27)
    call make_block(KIND_C3D8, 2, model, state, assembly)
    call create_assembly(assembly, model%mesh, error, coupled_first=[1, 3], coupled_nodes=[1, 27])
    call suite%that('blocks: created', .not. allocated(error))
    assembly%stiffness%value = 0
    call add_node_block(assembly, 1, 27, reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP, 7.0_DP, 8.0_DP, 9.0_DP], [3, 3]))
    u = 0
    u(:, 27) = [1.0_DP, 10.0_DP, 100.0_DP]
    f = product_of(assembly, u)
    call suite%near('blocks: upper', maxval(abs(f(:, 1) - [741.0_DP, 852.0_DP, 963.0_DP])), 0.0_DP, 0.0_DP)
    u = 0
    u(:, 1) = [1.0_DP, 10.0_DP, 100.0_DP]
    f = product_of(assembly, u)
    call suite%near('blocks: lower', maxval(abs(f(:, 27) - [321.0_DP, 654.0_DP, 987.0_DP])), 0.0_DP, 0.0_DP)
  end subroutine check_blocks

end program test_assembly
