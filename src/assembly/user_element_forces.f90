!> User elements: calls of the routine UEL, their sums in internal force and stiffness, their energies.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! RHS is minus the internal force, AMATRX the derivative of the force by the unknowns. Its symmetric part goes into K, the rest
!! (UNSYMM) into assembly%skew. Each call starts from the committed SVARS and ENERGY; the call for forces keeps the new ones. LFLAGS
!! as in Abaqus: D. Systemes, Abaqus User Subroutines Guide, UEL.
module amontons_user_element_forces
  use amontons_kinds, only: DP
  use amontons_assembly_plan, only: assembly_type, add_node_block, add_skew_block
  use amontons_model, only: model_type, is_out
  use amontons_section_beams, only: evaluate_section_beam
  use amontons_state, only: state_type, fields_type
  use amontons_steps, only: step_type
  use amontons_user_elements, only: user_element_type, user_kind_type, user_unknowns, N_UEL_ENERGIES, ENERGY_ELASTIC, &
    ENERGY_CREEP, ENERGY_PLASTIC
  use amontons_user_routines, only: uel_type, call_uel
  implicit none
  private
  public :: add_user_forces, add_user_stiffness, begin_user_elements, user_strain_energy, user_inelastic_work

contains

  !> Adds the forces of all user elements; their memory becomes that of the trial state.
  subroutine add_user_forces(model, step, state, failed)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< in: old memory, new u and times; out: new internal_force and memory
    integer, intent(out) :: failed                 !< 0, or the first element whose UEL gave no valid force
    real(DP), allocatable :: force(:), stiffness(:, :), memory(:)
    integer :: i, first
    failed = 0
    do i = 1, size(model%user_elements%elements)
      associate (element => model%user_elements%elements(i))
        if (is_out(model, step%number, element%element)) cycle
        call evaluate_user_element(model, step, state, element, force, stiffness, memory, failed)
        if (failed > 0) return
        first = memory_start(model, state%new, element)
        state%new%user_memory(first:first + size(memory) - 1) = memory
        call add_unknowns(user_unknowns(element), force, state%new%internal_force)
      end associate
    end do
  end subroutine add_user_forces


  !> Adds values to unknowns, of which one may be there several times.
  pure subroutine add_unknowns(unknowns, values, field)
    integer, intent(in) :: unknowns(:)
    real(DP), intent(in) :: values(:)              !< (unknowns) [force]
    real(DP), intent(inout) :: field(:, :)         !< (3, n_nodes) [force]
    integer :: k
    do k = 1, size(values)
      associate (sum => field(mod(unknowns(k) - 1, 3) + 1, (unknowns(k) + 2) / 3))
        sum = sum + values(k)
      end associate
    end do
  end subroutine add_unknowns


  !> Adds the stiffness of all user elements.
  subroutine add_user_stiffness(assembly, model, step, state, failed)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state          !< old memory, new u and times
    integer, intent(out) :: failed                 !< as above
    real(DP), allocatable :: force(:), stiffness(:, :), memory(:)
    integer :: i
    failed = 0
    do i = 1, size(model%user_elements%elements)
      associate (element => model%user_elements%elements(i))
        if (is_out(model, step%number, element%element)) cycle
        call evaluate_user_element(model, step, state, element, force, stiffness, memory, failed)
        if (failed > 0) return
        call scatter_stiffness(assembly, element, stiffness, model%user_elements%kinds(element%kind)%is_unsymmetric)
      end associate
    end do
  end subroutine add_user_stiffness


  !> Adds the stiffness of one element, block by block.
  subroutine scatter_stiffness(assembly, element, stiffness, is_unsymmetric)
    type(assembly_type), intent(inout) :: assembly
    type(user_element_type), intent(in) :: element
    real(DP), intent(in) :: stiffness(:, :)        !< (NDOFEL, NDOFEL) [force/length]
    logical, intent(in) :: is_unsymmetric
    real(DP) :: whole(3 * size(element%nodes), 3 * size(element%nodes))
    real(DP) :: block(3, 3), opposite(3, 3)
    integer :: a, b, i, j
    whole = 0
    do j = 1, size(element%place)
      do i = 1, size(element%place)
        associate (entry => whole(element%place(i), element%place(j)))
          entry = entry + stiffness(i, j)
        end associate
      end do
    end do
    do b = 1, size(element%nodes)
      do a = 1, size(element%nodes)
        if (element%nodes(a) > element%nodes(b)) cycle
        block = whole(3 * a - 2:3 * a, 3 * b - 2:3 * b)
        opposite = transpose(whole(3 * b - 2:3 * b, 3 * a - 2:3 * a))
        call add_node_block(assembly, element%nodes(a), element%nodes(b), 0.5_DP * (block + opposite))
        if (is_unsymmetric) call add_skew_block(assembly, element%nodes(a), element%nodes(b), 0.5_DP * (block - opposite))
      end do
    end do
  end subroutine scatter_stiffness


  !> Calls UEL for one element, from its committed memory.
  subroutine evaluate_user_element(model, step, state, element, force, stiffness, memory, failed)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    type(user_element_type), intent(in) :: element
    real(DP), allocatable, intent(out) :: force(:) !< (NDOFEL) -RHS [force]
    real(DP), allocatable, intent(out) :: stiffness(:, :)   !< AMATRX [force/length]
    real(DP), allocatable, intent(out) :: memory(:)   !< SVARS, ENERGY
    integer, intent(inout) :: failed               !< unchanged, or the element
    integer, parameter :: NORMAL_INCREMENT = 1     ! LFLAGS(3): force and stiffness, which every UEL gives
    type(uel_type) :: values
    if (model%user_elements%kinds(element%kind)%is_beam) then
      call evaluate_beam(model, state, element, force, stiffness, memory)
      return
    end if
    call call_element(model, step, state, element, NORMAL_INCREMENT, force, stiffness, memory, values)
    force = -force
    if (values%is_accepted == 1 .and. all(abs(force) <= huge(1.0_DP)) .and. all(abs(stiffness) <= huge(1.0_DP))) return
    failed = element%element
  end subroutine evaluate_user_element


  !> A beam by its section: force, stiffness and elastic energy of its displacements and small rotations.
  subroutine evaluate_beam(model, state, element, force, stiffness, memory)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(user_element_type), intent(in) :: element
    real(DP), allocatable, intent(out) :: force(:) !< (12) [force]
    real(DP), allocatable, intent(out) :: stiffness(:, :)   !< (12, 12) [force/length]
    real(DP), allocatable, intent(out) :: memory(:)   !< without SVARS: the energies [energy]
    real(DP) :: u(12)
    integer :: unknowns(12), k
    logical :: is_ok                               ! checked by the reader
    allocate (force(12), stiffness(12, 12), memory(N_UEL_ENERGIES))
    unknowns = user_unknowns(element)
    u = [(state%new%u(mod(unknowns(k) - 1, 3) + 1, (unknowns(k) + 2) / 3), k=1, 12)]
    associate (nodes => model%mesh%nodes(model%mesh%first(element%element):model%mesh%first(element%element) + 1))
      call evaluate_section_beam(model%user_elements%properties(element%properties)%section, model%mesh%coordinates(:, nodes), &
        stiffness, is_ok)
    end associate
    force = matmul(stiffness, u)
    memory = 0
    memory(ENERGY_ELASTIC) = 0.5_DP * dot_product(force, u)
  end subroutine evaluate_beam


  !> The first call for each element, with DTIME = 0: Abaqus requests a mass matrix at the start of every analysis, and routines
  !! initialize in it what they share. No result is kept.
  subroutine begin_user_elements(model, state)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state          !< at the start
    integer, parameter :: MASS_MATRIX = 4          ! LFLAGS(3)
    real(DP), allocatable :: force(:), stiffness(:, :), memory(:)
    type(uel_type) :: values
    integer :: i
    do i = 1, size(model%user_elements%elements)
      if (model%user_elements%kinds(model%user_elements%elements(i)%kind)%is_beam) cycle
      call call_element(model, model%steps(1), state, model%user_elements%elements(i), MASS_MATRIX, force, stiffness, memory, &
        values)
      if (values%is_accepted == 0) return
    end do
  end subroutine begin_user_elements


  !> One call of UEL.
  subroutine call_element(model, step, state, element, request, rhs, stiffness, memory, values)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    type(user_element_type), intent(in) :: element
    integer, intent(in) :: request                 !< LFLAGS(3)
    real(DP), allocatable, intent(out) :: rhs(:)   !< (NDOFEL) RHS [force]
    real(DP), allocatable, intent(out) :: stiffness(:, :)   !< AMATRX [force/length]
    real(DP), allocatable, intent(out) :: memory(:)   !< SVARS, ENERGY
    type(uel_type), intent(out) :: values          !< with the verdict of the routine
    integer, parameter :: STATIC_PROCEDURE = 1, DIRECT_PROCEDURE = 2, VISCO_PROCEDURE = 21   ! LFLAGS(1)
    real(DP), allocatable :: inputs(:)
    integer :: n, first
    associate (kind => model%user_elements%kinds(element%kind))
      n = size(element%place)
      first = memory_start(model, state%old, element)
      memory = state%old%user_memory(first:first + kind%n_svars + N_UEL_ENERGIES - 1)
      inputs = collect_inputs(model, state, element, kind)
      allocate (rhs(n), stiffness(n, n), source=0.0_DP)
      values%time = [state%new%step_time, state%new%total_time]
      values%dtime = state%new%total_time - state%old%total_time
      values%period = step%period
      values%lflags(1) = merge(DIRECT_PROCEDURE, STATIC_PROCEDURE, step%is_direct)
      if (step%has_creep) values%lflags(1) = VISCO_PROCEDURE
      values%lflags(2) = merge(1, 0, step%is_nlgeom)
      values%lflags(3) = request
      values%ndofel = n
      values%nsvars = kind%n_svars
      values%mcrd = kind%n_coordinates
      values%nnode = kind%n_nodes
      values%npredf = size(state%new%temperature) / model%mesh%n_nodes - first_predefined(model, state)
      values%jtype = kind%number
      values%element = model%mesh%element_label(element%element)
      values%step = max(1, state%new%step)
      values%increment = state%new%increment
      if (element%properties > 0) then
        associate (properties => model%user_elements%properties(element%properties))
          call call_uel(model%routines, properties%reals, properties%integers, inputs, rhs, stiffness, memory, values)
        end associate
      else
        call call_uel(model%routines, [real(DP) ::], [integer ::], inputs, rhs, stiffness, memory, values)
      end if
    end associate
  end subroutine call_element


  !> What PREDEF begins with: 0 the temperature; 1 the first field variable, if the deck has such ones and no temperature.
  pure integer function first_predefined(model, state) result(first)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    first = merge(0, 1, model%user_elements%has_temperature .or. size(state%new%temperature) == model%mesh%n_nodes)
  end function first_predefined


  !> COORDS, U, DU and PREDEF of an element, one after the other.
  pure function collect_inputs(model, state, element, kind) result(inputs)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(user_element_type), intent(in) :: element
    type(user_kind_type), intent(in) :: kind
    real(DP), allocatable :: inputs(:)
    integer, allocatable :: unknowns(:)
    real(DP) :: u(size(element%place)), du(size(element%place))
    integer :: a, f, k, n, component, node, n_fields, first
    associate (mesh => model%mesh)
      first = first_predefined(model, state)
      n_fields = size(state%new%temperature) / mesh%n_nodes - first
      unknowns = user_unknowns(element)
      do k = 1, size(unknowns)
        node = (unknowns(k) + 2) / 3
        component = mod(unknowns(k) - 1, 3) + 1
        u(k) = state%new%u(component, node)
        du(k) = u(k) - state%old%u(component, node)
      end do
      allocate (inputs((kind%n_coordinates + 2 * n_fields) * kind%n_nodes + 2 * size(u)))
      n = 0
      do a = 1, kind%n_nodes
        node = mesh%nodes(mesh%first(element%element) + a - 1)
        inputs(n + 1:n + kind%n_coordinates) = mesh%coordinates(:kind%n_coordinates, node)
        n = n + kind%n_coordinates
      end do
      inputs(n + 1:n + 2 * size(u)) = [u, du]
      n = n + 2 * size(u)
      do a = 1, kind%n_nodes
        do f = first, first + n_fields - 1
          k = f * mesh%n_nodes + mesh%nodes(mesh%first(element%element) + a - 1)
          inputs(n + 1:n + 2) = [state%new%temperature(k), state%new%temperature(k) - state%old%temperature(k)]
          n = n + 2
        end do
      end do
    end associate
  end function collect_inputs


  !> Where the memory of an element begins in user_memory.
  pure integer function memory_start(model, fields, element) result(first)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(user_element_type), intent(in) :: element
    first = size(fields%user_memory) - model%user_elements%n_memory + element%memory + 1
  end function memory_start


  !> The sum of one of the energies of all user elements; 0 without user elements.
  pure real(DP) function sum_energy(model, fields, which) result(energy)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: which                   !< ENERGY_...
    integer :: i
    energy = 0
    if (.not. allocated(model%user_elements)) return
    do i = 1, size(model%user_elements%elements)
      associate (element => model%user_elements%elements(i))
        energy = energy + fields%user_memory(memory_start(model, fields, element) + which - 1 &
          + model%user_elements%kinds(element%kind)%n_svars)
      end associate
    end do
  end function sum_energy


  !> The elastic strain energy that UEL gives [energy].
  pure real(DP) function user_strain_energy(model, fields) result(energy)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    energy = sum_energy(model, fields, ENERGY_ELASTIC)
  end function user_strain_energy


  !> The energy dissipated by plasticity and creep since the start, as UEL gives it [energy].
  pure real(DP) function user_inelastic_work(model, fields) result(energy)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    energy = sum_energy(model, fields, ENERGY_PLASTIC) + sum_energy(model, fields, ENERGY_CREEP)
  end function user_inelastic_work

end module amontons_user_element_forces
